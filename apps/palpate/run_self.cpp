// SPDX-License-Identifier: Apache-2.0
#include "run_self.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/console/interrupt.hpp"
#include "base/error.hpp"
#include "base/leftover.hpp"

namespace palpate {
namespace {

constexpr const char* kSelf = "/proc/self/exe";

// Its end, as waitpid() tells it. A request to stop is handed on, once: one from the terminal has reached it already,
// and it takes the two for one.
int waitFor(pid_t child) {
  constexpr std::chrono::milliseconds kChildLook{20};
  int status = 0;
  for (bool told = false;; std::this_thread::sleep_for(kChildLook)) {
    if (interrupted() && !told) kill(child, SIGTERM);
    told = interrupted();
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) return status;
  }
}

}  // namespace

std::string runSelf(const std::vector<std::string>& words) {
  std::vector<std::string> all = {"palpate"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  int failure = 0;
  Leftover leftover = Leftover::process([&] {
    failure = posix_spawn(&child, kSelf, &actions, nullptr, arguments.data(), environ);
    return failure == 0 ? child : -1;
  });
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) {
    throw Error(Error::Code::kIo, "palpate", fmt::format("no process can be started ({})", std::strerror(failure)),
                "end other programs, or raise the limit of processes (ulimit -u)");
  }
  const int status = waitFor(child);
  leftover.release();
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  if (WIFSIGNALED(status)) return fmt::format("it was ended by signal {}", WTERMSIG(status));
  return fmt::format("it ended with status {}; its message is above", WEXITSTATUS(status));
}

}  // namespace palpate
