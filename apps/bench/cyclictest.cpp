// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/cyclictest.hpp"

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <sstream>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/leftover.hpp"

namespace palpate {
namespace {

constexpr int kShellFindsNoCommand = 127;

// Text that one line of a note can hold.
std::string lastLine(const std::string& text) {
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

// A command of the shell, both of whose streams are read. It ends with its owner: popen() would leave it running where
// this process is stopped.
class Shell {
 public:
  explicit Shell(const std::string& command) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
    out_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    std::string words[] = {"sh", "-c", "exec " + command};  // in the shell's place, so that it is what is ended
    std::array<char*, 4> arguments = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    leftover_ = Leftover::process([&] {
      if (posix_spawn(&child_, "/bin/sh", &actions, nullptr, arguments.data(), environ) != 0) child_ = -1;
      return child_;
    });
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
  }
  ~Shell() {
    if (child_ > 0) kill(child_, SIGKILL);
    static_cast<void>(wait());
    if (out_ >= 0) close(out_);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  [[nodiscard]] std::string readAll() const {
    std::string text;
    std::array<char, 4096> block{};
    for (ssize_t got = 0; out_ >= 0 && (got = read(out_, block.data(), block.size())) != 0;) {
      if (got > 0) text.append(block.data(), static_cast<std::size_t>(got));
      if (got < 0 && errno != EINTR) break;
    }
    return text;
  }
  // As waitpid() gives it; -1: it was never started.
  [[nodiscard]] int wait() {
    leftover_.release();  // its number may be another's once it is waited for
    int status = -1;
    while (child_ > 0 && waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return status;
  }

 private:
  pid_t child_ = -1;
  int out_ = -1;
  Leftover leftover_;
};

}  // namespace

std::string cyclictestCommand(const CyclictestRequest& request) {
  return fmt::format(
      "cyclictest --quiet --mlockall --default-system --threads=1 --interval={} --loops={} --histogram={} {}",
      std::llround(1e6 / request.rate_hz), request.cycles, LatenessCounts::kOverflow_us,
      request.fifo ? fmt::format("--policy=fifo --priority={}", request.priority) : "--policy=other");
}

CyclictestOutcome runCyclictest(const CyclictestRequest& request) {
  CyclictestOutcome outcome;
  Shell shell(cyclictestCommand(request));
  const std::string text = shell.readAll();
  const int status = shell.wait();
  if (status < 0) {
    outcome.trouble = "no shell could be started";
  } else if (WIFEXITED(status) && WEXITSTATUS(status) == kShellFindsNoCommand) {
    outcome.trouble = "cyclictest is not installed; apt-get install rt-tests";
  } else if (const auto counts = parseCyclictest(text); status == 0 && counts) {
    outcome.lateness = *counts;
  } else {
    outcome.trouble = fmt::format("cyclictest failed (status {}): {}", status, lastLine(text));
  }
  return outcome;
}

std::optional<LatenessCounts> parseCyclictest(const std::string& text) {
  LatenessCounts counts;
  std::istringstream in(text);
  const std::string overflows = "# Histogram Overflows:";
  for (std::string line; std::getline(in, line);) {
    std::int64_t us = 0, times = 0;
    if (line.starts_with(overflows)) {
      if (std::istringstream(line.substr(overflows.size())) >> times && times > 0) {
        counts.add(LatenessCounts::kOverflow_us, times);
      }
    } else if (!line.empty() && line[0] >= '0' && line[0] <= '9') {
      if (std::istringstream(line) >> us >> times && times > 0) counts.add(us, times);
    }
  }
  return counts.total() > 0 ? std::optional(counts) : std::nullopt;
}

}  // namespace palpate
