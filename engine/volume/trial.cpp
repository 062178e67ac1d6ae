// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/trial.hpp"

#include <array>
#include <cerrno>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/leftover.hpp"

namespace palpate {
namespace {

constexpr unsigned kLongest_s = 60;  // for one piece of work

// No core file, nothing on the screen.
void beSilent() {
  const rlimit none = {0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const int sink = open("/dev/null", O_WRONLY);
  dup2(sink, STDOUT_FILENO);
  dup2(sink, STDERR_FILENO);
}

// The child: one byte into the pipe for each piece of work that it survives. It never returns.
[[noreturn]] void runChild(int pipe_in, std::size_t count, const std::function<void(std::size_t)>& work) {
  beSilent();
  for (std::size_t n = 0; n < count; ++n) {
    alarm(kLongest_s);
    try {
      work(n);
    } catch (...) {  // the parent will meet it again and report it
    }
    if (write(pipe_in, "x", 1) != 1) break;
  }
  _exit(0);
}

std::size_t countBytes(int pipe_out) {
  std::array<char, 256> bytes;
  std::size_t total = 0;
  for (;;) {
    const ssize_t got = read(pipe_out, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return total;
    total += static_cast<std::size_t>(got);
  }
}

}  // namespace

std::optional<std::size_t> firstFatal(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::array<int, 2> ends = {-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  const pid_t child = fork();
  if (child == 0) runChild(ends[1], count, work);
  Leftover leftover = child > 0 ? Leftover::process(child) : Leftover();
  close(ends[1]);
  const std::size_t survived = child > 0 ? countBytes(ends[0]) : count;
  close(ends[0]);
  leftover.release();  // its number may be another's once it is waited for
  while (child > 0 && waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  if (survived >= count) return {};
  return survived;
}

}  // namespace palpate
