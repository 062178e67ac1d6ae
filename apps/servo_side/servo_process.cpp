// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/servo_process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kTheirs = 3;  // the descriptor over there

}  // namespace

std::filesystem::path servoProgram() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path() / "palpate-servo";
}

ServoProcess::ServoProcess() {
  const std::filesystem::path program = servoProgram();
  auto [ours, theirs] = channelPair();
  std::string name = "palpate-servo", flag = "--channel", number = std::to_string(kTheirs);
  char* const words[] = {name.data(), flag.data(), number.data(), nullptr};
  // A signal to this program's group is not for it: killed with the engine, it could not bring the force to zero.
  posix_spawnattr_t own_group;
  posix_spawnattr_init(&own_group);
  posix_spawnattr_setflags(&own_group, POSIX_SPAWN_SETPGROUP);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, theirs.descriptor(), kTheirs);
  const int failure = posix_spawn(&id_, program.c_str(), &actions, &own_group, words, environ);
  posix_spawnattr_destroy(&own_group);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    throw Error(failure == ENOENT ? Error::Code::kNotFound : Error::Code::kIo, program.string(),
                fmt::format("the servo's program cannot be started ({})", std::strerror(failure)),
                "build it with ./dev build, or leave --service out");
  }
  channel_ = std::move(ours);
}

ServoProcess::~ServoProcess() {
  if (id_ <= 0) return;
  channel_.close();
  constexpr int kLook_ms = 5;
  int status = 0;
  for (int waited_ms = 0; waited_ms < kPatience_ms; waited_ms += kLook_ms) {
    if (waitpid(id_, &status, WNOHANG) != 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
  }
  kill(id_, SIGKILL);
  waitpid(id_, &status, 0);
}

}  // namespace palpate
