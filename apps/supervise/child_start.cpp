// SPDX-License-Identifier: Apache-2.0
#include "apps/supervise/child_start.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/close_from.hpp"
#include "base/descriptor.hpp"
#include "base/end_with_parent.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr int kFirstNotInherited = 3;
constexpr int kNotStarted = 127;  // as a shell has it

bool isProgram(const std::string& path) {
  struct stat found {};
  return stat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode) && access(path.c_str(), X_OK) == 0;
}

// By execvp()'s rules, but before the fork: after it nothing may allocate. What is not found is returned as it is.
std::string alongPath(const std::string& program) {
  if (program.find('/') != std::string::npos) return program;
  const char* path = std::getenv("PATH");
  for (std::string_view rest = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin"; !rest.empty();) {
    const std::string_view folder = rest.substr(0, rest.find(':'));
    rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    std::string candidate = fmt::format("{}/{}", folder.empty() ? "." : folder, program);
    if (isProgram(candidate)) return candidate;
  }
  return program;
}

[[noreturn]] void refuseStart(const std::string& name, const std::string& program, int failure) {
  if (failure == ENOENT) {
    throw Error(Error::Code::kNotFound, program,
                fmt::format("there is no such program, or not what it needs to be run, so {} cannot be started", name),
                program.find('/') != std::string::npos ? "give the path of a program"
                                                       : "install it, or put its folder into PATH");
  }
  const bool no_process = failure == EAGAIN || failure == ENOMEM;
  throw Error(Error::Code::kIo, program, fmt::format("{} cannot be started ({})", name, std::strerror(failure)),
              no_process ? kFreeProcesses : "give a program that this user may run");
}

struct ChildPlan {
  const char* program;
  char* const* words;
  pid_t parent;
  int report;  // where the errno of a failure is written
};

void resetSignals() noexcept {
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction now {};
    if (signal == SIGHUP && sigaction(signal, nullptr, &now) == 0 && now.sa_handler == SIG_IGN) continue;
    sigaction(signal, &usual, nullptr);  // refused for SIGKILL, SIGSTOP and those of the C library
  }
}

// In the child, where other threads' locks may be held for ever: only system calls that a signal handler may make.
[[noreturn]] void becomeProgram(const ChildPlan& plan) noexcept {
  setpgid(0, 0);
  endWithParent(plan.parent, SIGTERM);
  resetSignals();
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  closeFrom(kFirstNotInherited, Closing::kInPrograms);
  execv(plan.program, plan.words);
  const int failure = errno;
  static_cast<void>(!write(plan.report, &failure, sizeof failure));
  _exit(kNotStarted);
}

// The errno that the child wrote; 0: the program runs, since the pipe was closed by its exec.
int reportedFailure(int from) noexcept {
  int failure = 0;
  ssize_t got = 0;
  do {
    got = read(from, &failure, sizeof failure);
  } while (got < 0 && errno == EINTR);
  return got == sizeof failure ? failure : 0;
}

}  // namespace

pid_t startChild(const std::string& name, const std::vector<std::string>& argv) {
  if (argv.empty() || argv.front().empty()) refuse(name, "no program is given", "give a program and its arguments");
  const std::string program = alongPath(argv.front());
  std::vector<std::string> texts = argv;
  std::vector<char*> words;
  for (std::string& text : texts) words.push_back(text.data());
  words.push_back(nullptr);
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) refuseStart(name, argv.front(), errno);
  const Descriptor from(pipe_ends[0]);
  Descriptor report(pipe_ends[1]);

  // A handler of this process must not run in the child: it would put the signal into this process's inbox.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  const ChildPlan plan{.program = program.c_str(), .words = words.data(), .parent = getpid(), .report = report.get()};
  const pid_t child = fork();
  if (child == 0) becomeProgram(plan);
  const int fork_failure = errno;
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (child < 0) refuseStart(name, argv.front(), fork_failure);
  setpgid(child, child);  // here too, so that the group exists when this returns
  report.close();
  if (const int failure = reportedFailure(from.get()); failure != 0) {
    waitpid(child, nullptr, 0);
    refuseStart(name, argv.front(), failure);
  }
  return child;
}

}  // namespace palpate
