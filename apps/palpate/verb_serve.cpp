// SPDX-License-Identifier: Apache-2.0
// palpate serve VOLUME|SCENE: the engine as a service; palpate servo: the servo that joins one.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
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
#include "apps/servo_side/servo_process.hpp"
#include "apps/supervise/supervisor.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "service/channel/usual_socket.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

constexpr double kEnginesEnd_s = 600;  // it may have a large file to write
constexpr double kServosEnd_s = 15;    // its force fades, for 10 s at most
constexpr const char* kSupervise = "--supervise";
const int kBadInputStatus = exitStatus(Error::Code::kBadInput), kNotFoundStatus = exitStatus(Error::Code::kNotFound);

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

// Engine and servo as children, which are started again when one dies. The engine's good end is that of both.
void superviseBoth(const std::string& socket) {
  const SupervisionEnd end = supervise({{.name = "engine",
                                         .argv = ownCommand(),
                                         .essential = true,
                                         .hopeless = {kBadInputStatus, kNotFoundStatus},
                                         .patience_s = kEnginesEnd_s},
                                        {.name = "servo",
                                         .argv = {servoProgram().string(), "--connect", socket},
                                         .essential = false,
                                         .patience_s = kServosEnd_s}});
  if (end.killed > 0) {
    throw Error(Error::Code::kDevice, "palpate serve --supervise",
                fmt::format("{} of its processes did not end in time and were killed", end.killed),
                "see their last messages; edits are in the journal");
  }
}

// Does not return but with an error.
[[noreturn]] void becomeServo(std::string socket, bool is_open) {
  const std::filesystem::path program = servoProgram();
  std::string name = program.string(), flag = "--connect", open = "--no-sandbox";
  char* const words[] = {name.data(), flag.data(), socket.data(), is_open ? open.data() : nullptr, nullptr};
  execv(program.c_str(), words);
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
        return superviseBoth(socketOf(scene));
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
  verb->callback([socket, is_open] { becomeServo(socket->empty() ? usualSocket() : *socket, *is_open); });
}

}  // namespace palpate
