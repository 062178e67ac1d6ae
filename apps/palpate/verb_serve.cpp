// SPDX-License-Identifier: Apache-2.0
// palpate serve VOLUME|SCENE: the engine as a service; palpate servo: the servo that joins one.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/message.hpp"
#include "apps/console/progress.hpp"
#include "apps/scene/flag_errors.hpp"
#include "apps/scene/scene_file.hpp"
#include "apps/serve/serve_job.hpp"
#include "apps/serve/served_engine.hpp"
#include "apps/serve/service_place.hpp"
#include "apps/servo_side/servo_ceilings.hpp"
#include "apps/servo_side/servo_process.hpp"
#include "apps/supervise/hopeless_statuses.hpp"
#include "apps/supervise/supervisor.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "service/channel/usual_socket.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr double kEnginesEnd_s = 600;  // it may have a large file to write
constexpr const char* kSupervise = "--supervise";

std::filesystem::path thisProgram() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown);
}

// The words of this command, without the one that asked for a supervisor.
std::vector<std::string> ownCommand() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(file, word, '\0');)
    if (words.empty() || (word != kSupervise && !word.starts_with(fmt::format("{}=", kSupervise))))
      words.push_back(word);
  words.at(0) = thisProgram().string();
  return words;
}

// Engine and servo as children, which are started again when one dies. The engine's good end is that of both. A servo
// that cannot read its ceilings is not started again: it could not read them then either.
void superviseBoth(const Scene& scene) {
  std::vector<std::string> servo = {servoProgram().string(), "--connect", socketOf(scene)};
  if (scene.device_calibrated) servo.emplace_back("--calibrated");  // who says so starts both
  const SupervisionEnd end = supervise({{.name = "engine",
                                         .argv = ownCommand(),
                                         .essential = true,
                                         .hopeless = hopelessForEngine(),
                                         .patience_s = kEnginesEnd_s},
                                        {.name = "servo",
                                         .argv = std::move(servo),
                                         .essential = false,
                                         .hopeless = hopelessForServo(),
                                         .patience_s = kServosEnd_s + longestFade_s(scene)}});
  if (end.killed > 0) {
    throw Error(Error::Code::kDevice, "palpate serve --supervise",
                fmt::format("{} of its processes did not end in time and were killed", end.killed),
                "see their last messages; edits are in the journal");
  }
}

// Does not return but with an error.
[[noreturn]] void becomeServo(const std::string& socket, const std::vector<std::string>& more) {
  const std::filesystem::path program = servoProgram();
  std::vector<std::string> words = {program.string(), "--connect", socket};
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  throw Error(errno == ENOENT ? Error::Code::kNotFound : Error::Code::kIo, program.string(),
              fmt::format("the servo's program cannot be started ({})", std::strerror(errno)),
              "build it with ./dev build");
}

}  // namespace

void addServeVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("serve", "serve a volume to a servo and to clients, as one of several processes");
  verb->footer(
      "Another terminal: palpate servo --connect SOCKET; palpate ctl edit ...; docs/service.md\n"
      "Example: palpate serve 'phantom:knot?size=64' --supervise");
  auto arguments = std::make_shared<SceneArguments>(*verb, SceneArguments::Of::kService);
  auto supervised = std::make_shared<bool>(false);
  verb->add_flag(kSupervise, *supervised, "start a servo, too, and start either again when it dies");
  verb->callback([arguments, supervised] {
    try {
      const Scene scene = arguments->scene();
      if (scene.service_log == "json") setMessageForm(MessageForm::kJson);
      if (*supervised) {
        checkServable(scene);  // its errors are told once
        return superviseBoth(scene);
      }
      Progress progress;
      const bool has_file = arguments->source().ends_with(kSceneExtension);
      serveScene({.scene = scene,
                  .read_again = has_file ? std::function([arguments] { return arguments->scene(); }) : nullptr,
                  .commit = programCommit()},
                 progress);
    } catch (const Error& error) {
      throw withFlag(error);
    }
  });
}

void addServoVerb(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("servo", "run the device and the haptic loop for a service");
  verb->footer(
      "It stays when the service ends: the force fades, and it goes on with the next one. SIGTERM ends it.\n"
      "Example: palpate servo --connect /run/user/1000/palpate/service.sock");
  auto socket = std::make_shared<std::string>(usualSocket());
  verb->add_option("--connect,--socket", *socket, "the socket of the service; without a name, the usual one")
      ->capture_default_str()
      ->expected(0, 1);
  auto is_open = std::make_shared<bool>(false);
  verb->add_flag("--no-sandbox", *is_open, "keep all rights, so that a debugger can look into it");
  auto is_calibrated = std::make_shared<bool>(false);
  verb->add_flag("--calibrated", *is_calibrated, "believe an engine that says that the device is calibrated already");
  auto ceilings = std::make_shared<std::vector<std::optional<double>>>(ceilingRows().size());
  for (std::size_t i = 0; i < ceilings->size(); ++i) {
    const CeilingRow& row = ceilingRows()[i];
    verb->add_option(std::string(row.flag), (*ceilings)[i],
                     fmt::format("{} [{}], whatever an engine asks for; '{}' in {}", row.help, row.unit, row.key,
                                 "~/.config/palpate/servo.toml"))
        ->check(CLI::Range(row.lowest, row.highest));
  }
  verb->callback([socket, is_open, is_calibrated, ceilings] {
    std::vector<std::string> more;
    if (*is_open) more.emplace_back("--no-sandbox");
    if (*is_calibrated) more.emplace_back("--calibrated");
    for (std::size_t i = 0; i < ceilings->size(); ++i) {
      if (!(*ceilings)[i]) continue;
      more.emplace_back(ceilingRows()[i].flag);
      more.push_back(fmt::format("{}", *(*ceilings)[i]));
    }
    becomeServo(socket->empty() ? usualSocket() : *socket, more);
  });
}

}  // namespace palpate
