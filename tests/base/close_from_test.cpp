// SPDX-License-Identifier: Apache-2.0
// What is closed, and what not: by what fcntl(2) says of each descriptor, with close_range(2) and without.
#include "base/close_from.hpp"

#include <cerrno>
#include <functional>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "without_call.hpp"

namespace palpate {
namespace close_from_test {

constexpr int kNoFilter = 100, kFirst = 20, kKept = 30, kLast = 300;

// In a child, whose descriptors are 20, 30 and 300 besides those that it was given.
int inChild(bool is_old, const std::function<bool()>& holds) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit many = {kLast + 1, kLast + 1};
    setrlimit(RLIMIT_NOFILE, &many);
    for (const int number : {kFirst, kKept, kLast}) dup2(STDERR_FILENO, number);
    const rlimit few = {kKept, kLast + 1};  // lowered after they were opened
    setrlimit(RLIMIT_NOFILE, &few);
    if (is_old && !loseCall(SYS_close_range, ENOSYS)) _exit(kNoFilter);
    _exit(holds() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool isOpen(int number) {
  return fcntl(number, F_GETFD) >= 0;
}
bool endsInPrograms(int number) {
  return isOpen(number) && (fcntl(number, F_GETFD) & FD_CLOEXEC) != 0;
}

class CloseFrom : public testing::TestWithParam<bool> {
 protected:
  void expectTrue(const std::function<bool()>& holds) const {
    const int result = inChild(GetParam(), holds);
    if (result == kNoFilter) GTEST_SKIP() << "this kernel has no filter that could take close_range away";
    EXPECT_EQ(result, 0);
  }
};

TEST_P(CloseFrom, ClosesAll) {
  expectTrue([] {
    closeFrom(kFirst, Closing::kNow);
    return !isOpen(kFirst) && !isOpen(kKept) && !isOpen(kLast) && isOpen(STDERR_FILENO);
  });
}

TEST_P(CloseFrom, KeepsOne) {
  expectTrue([] {
    closeFrom(kFirst, Closing::kNow, kKept);
    return !isOpen(kFirst) && isOpen(kKept) && !isOpen(kLast);
  });
  expectTrue([] {
    closeFrom(kFirst, Closing::kNow, kFirst);
    return isOpen(kFirst) && !isOpen(kKept) && !isOpen(kLast);
  });
  expectTrue([] {  // one that is not among them
    closeFrom(kFirst, Closing::kNow, STDERR_FILENO);
    return !isOpen(kFirst) && !isOpen(kKept) && !isOpen(kLast) && isOpen(STDERR_FILENO);
  });
}

TEST_P(CloseFrom, LeavesThemOpenUntilAProgramIsRun) {
  expectTrue([] {
    closeFrom(kKept, Closing::kInPrograms);
    return isOpen(kFirst) && !endsInPrograms(kFirst) && endsInPrograms(kKept) && endsInPrograms(kLast);
  });
}

INSTANTIATE_TEST_SUITE_P(NewAndOldKernels, CloseFrom, testing::Bool(),
                         [](const auto& one) { return std::string(one.param ? "WithoutTheCall" : "WithTheCall"); });

}  // namespace close_from_test
}  // namespace palpate
