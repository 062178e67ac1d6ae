// SPDX-License-Identifier: Apache-2.0
// palpate serve VOLUME|SCENE: the engine as a service; palpate servo: the servo that joins one.
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "apps/console/progress.hpp"
#include "apps/scene/flag_errors.hpp"
#include "apps/serve/serve_job.hpp"
#include "apps/serve/service_place.hpp"
#include "base/error.hpp"
#include "scene_arguments.hpp"
#include "verbs.hpp"
#include "version.hpp"

namespace palpate {
namespace {

// Does not return but with an error.
[[noreturn]] void becomeServo(std::string socket) {
  std::error_code unknown;
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / "palpate-servo";
  std::string name = program.string(), flag = "--connect";
  char* const words[] = {name.data(), flag.data(), socket.data(), nullptr};
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
      "Example: palpate serve 'phantom:knot?size=64' --path knot.csv");
  auto arguments = std::make_shared<SceneArguments>(*verb);
  auto socket = std::make_shared<std::string>(usualSocket());
  verb->add_option("--socket", *socket, "where servo and clients connect")->capture_default_str()->check(notEmpty);
  verb->callback([arguments, socket] {
    Progress progress;
    try {
      serveScene({.scene = arguments->scene(),
                  .read_again = [arguments] { return arguments->scene(); },
                  .socket = *socket,
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
  verb->add_option("--connect", *socket, "the socket of the service")->capture_default_str()->check(notEmpty);
  verb->callback([socket] { becomeServo(*socket); });
}

}  // namespace palpate
