// SPDX-License-Identifier: Apache-2.0
#include "base/process_start.hpp"

#include <array>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

namespace palpate {
namespace process_start_test {

std::int64_t read_ns(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return time.tv_sec * std::int64_t{1'000'000'000} + time.tv_nsec;
}

// A new process that works for 20 ms before it asks: what it worked lies behind its start. (No other test of this
// program may ask before: the answer is kept, and a fork would inherit it.)
TEST(ProcessStart, LiesBeforeTheProcessorTimeThatWasUsed) {
  constexpr std::int64_t kWork_ns = 20'000'000;
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  const std::int64_t before_ns = read_ns(CLOCK_MONOTONIC);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    while (read_ns(CLOCK_PROCESS_CPUTIME_ID) < kWork_ns) {
    }
    const std::array<std::int64_t, 3> told = {processStart_ns(), read_ns(CLOCK_MONOTONIC), processStart_ns()};
    _exit(write(pipe_ends[1], told.data(), sizeof told) == sizeof told ? 0 : 1);
  }
  std::array<std::int64_t, 3> told{};
  ASSERT_EQ(read(pipe_ends[0], told.data(), sizeof told), static_cast<ssize_t>(sizeof told));
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_GE(told[0], before_ns);
  EXPECT_LE(told[0], told[1] - kWork_ns);
  EXPECT_EQ(told[2], told[0]);
  for (const int end : pipe_ends) close(end);
}

}  // namespace process_start_test
}  // namespace palpate
