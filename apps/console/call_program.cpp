// SPDX-License-Identifier: Apache-2.0
#include "apps/console/call_program.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/console/interrupt.hpp"
#include "base/descriptor.hpp"
#include "base/error.hpp"
#include "base/leftover.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseProcess(int failure) {
  throw Error(Error::Code::kIo, "palpate", fmt::format("no process can be started ({})", std::strerror(failure)),
              kFreeProcesses);
}

// Its end, as waitpid() tells it. A request to stop is handed on, once: one from the terminal has reached it already,
// and it takes the two for one.
int waitFor(pid_t child) {
  constexpr int kLook_ms = 20;
  // Wakes up at once; -1, on an old kernel: at the next look. (The C library's own header is not for C++.)
  const Descriptor watch(static_cast<int>(syscall(SYS_pidfd_open, child, 0)));
  int status = 0;
  for (bool told = false;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child || (ended < 0 && errno != EINTR)) return status;
    if (interrupted() && !told) kill(child, SIGTERM);
    told = interrupted();
    pollfd end{.fd = watch.get(), .events = POLLIN, .revents = 0};
    static_cast<void>(poll(&end, 1, kLook_ms));
  }
}

ProgramEnd endOf(int status, bool shows_messages) {
  if (WIFSIGNALED(status)) {
    return {.signal = WTERMSIG(status), .failure = fmt::format("it was ended by signal {}", WTERMSIG(status))};
  }
  ProgramEnd end{.status = WEXITSTATUS(status)};
  if (end.status != 0) {
    end.failure = fmt::format("it ended with status {}{}", end.status, shows_messages ? "; its message is above" : "");
  }
  return end;
}

}  // namespace

ProgramEnd callProgram(const ProgramCall& call) {
  std::vector<std::string> all = {"palpate"};
  all.insert(all.end(), call.words.begin(), call.words.end());
  std::vector<char*> arguments;
  for (std::string& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const Descriptor kept(call.shows_messages ? -1 : memfd_create("messages", MFD_CLOEXEC));
  if (!call.shows_messages && kept.get() < 0) refuseProcess(errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (!call.shows_messages) posix_spawn_file_actions_adddup2(&actions, kept.get(), STDERR_FILENO);
  pid_t child = -1;
  int failure = 0;
  Leftover leftover = Leftover::process([&] {
    failure = posix_spawn(&child, call.program.c_str(), &actions, nullptr, arguments.data(), environ);
    return failure == 0 ? child : -1;
  });
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) refuseProcess(failure);
  ProgramEnd end = endOf(waitFor(child), call.shows_messages);
  leftover.release();
  if (!call.shows_messages) {
    std::ifstream file("/proc/self/fd/" + std::to_string(kept.get()), std::ios::binary);
    end.messages.assign(std::istreambuf_iterator<char>(file), {});
  }
  return end;
}

}  // namespace palpate
