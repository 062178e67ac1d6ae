// SPDX-License-Identifier: Apache-2.0
#include "base/child_process.hpp"

#include <csignal>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/shared_buffer.hpp"

namespace palpate {
namespace child_process_test {

using Kind = ChildTrouble::Kind;

// One piece of work, with the trouble that it meets.
ChildTrouble troubleIn(const std::function<std::string(std::size_t)>& work, const ChildLimits& limits = {}) {
  const ChildOutcome outcome = runInChild("file", 1, limits, work);
  EXPECT_TRUE(outcome.results.empty());
  EXPECT_TRUE(outcome.trouble);
  return outcome.trouble.value_or(ChildTrouble{});
}

TEST(ChildProcess, HandsBackWhatEachPieceReturns) {
  const std::string large(std::size_t{3} << 20, 'x');  // more than a pipe holds
  const std::vector<std::string> wanted = {"", std::string("a\0b", 3), large};
  const ChildOutcome outcome = runInChild("file", 3, {}, [&](std::size_t n) { return wanted[n]; });
  EXPECT_FALSE(outcome.trouble);
  EXPECT_EQ(outcome.results, wanted);
}

TEST(ChildProcess, SharesOnlyWhatIsShared) {
  const SharedBuffer shared(5);
  int own = 1;
  const ChildOutcome outcome = runInChild("file", 1, {}, [&](std::size_t) {
    own = 2;
    std::copy_n("hello", 5, shared.bytes().begin());
    return std::string();
  });
  EXPECT_FALSE(outcome.trouble);
  EXPECT_EQ(own, 1);
  EXPECT_EQ(std::string(shared.bytes().begin(), shared.bytes().end()), "hello");
}

TEST(ChildProcess, ThrownErrorsComeBackWhole) {
  const ChildTrouble trouble =
      troubleIn([](std::size_t) -> std::string { throw Error(Error::Code::kOutOfMemory, "a", "", "c; d"); });
  EXPECT_EQ(trouble.kind, Kind::kError);
  ASSERT_TRUE(trouble.error);
  EXPECT_EQ(trouble.error->code(), Error::Code::kOutOfMemory);
  EXPECT_EQ(trouble.error->input(), "a");
  EXPECT_EQ(trouble.error->reason(), "");
  EXPECT_EQ(trouble.error->remedy(), "c; d");
}

TEST(ChildProcess, OtherExceptionsKeepTheirWords) {
  const ChildTrouble trouble = troubleIn([](std::size_t) -> std::string { throw std::runtime_error("why"); });
  EXPECT_EQ(trouble.kind, Kind::kException);
  EXPECT_EQ(trouble.words, "why");
  EXPECT_EQ(troubleIn([](std::size_t) -> std::string { throw 1; }).kind, Kind::kException);
}

TEST(ChildProcess, ACrashEndsTheChildOnly) {
  const ChildOutcome outcome = runInChild("file", 3, {}, [](std::size_t n) {
    if (n == 1) std::abort();
    return std::to_string(n);
  });
  EXPECT_EQ(outcome.results, std::vector<std::string>{"0"});
  ASSERT_TRUE(outcome.trouble);
  EXPECT_EQ(outcome.trouble->kind, Kind::kDied);
  EXPECT_THAT(outcome.trouble->words, testing::HasSubstr("crash"));
}

TEST(ChildProcess, AnEndOfTheProcessIsNoSuccess) {
  EXPECT_EQ(troubleIn([](std::size_t) -> std::string { _exit(0); }).kind, Kind::kDied);
}

// 0.2 s of a processor; the system counts whole seconds.
TEST(ChildProcess, AnEndlessLoopIsEnded) {
  ChildLimits limits;
  limits.cpu_s = 0.2;
  const auto loop = [](std::size_t) -> std::string {
    for (volatile int n = 0;;) static_cast<void>(n);
  };
  EXPECT_EQ(troubleIn(loop, limits).kind, Kind::kTooLong);
  const auto wait = [](std::size_t) -> std::string {
    for (;;) pause();
  };
  EXPECT_EQ(troubleIn(wait, limits).kind, Kind::kTooLong);
}

TEST(ChildProcess, MoreThanTheMemoryIsRefused) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's shadow is larger than any limit";
#endif
  ChildLimits limits;
  limits.memory_bytes = std::size_t{64} << 20;
  const auto ask = [](std::size_t bytes) {
    return [bytes](std::size_t) { return std::string(1, std::vector<char>(bytes, 'y').back()); };
  };
  EXPECT_EQ(troubleIn(ask(std::size_t{256} << 20), limits).kind, Kind::kMemory);
  EXPECT_EQ(runInChild("file", 1, limits, ask(std::size_t{32} << 20)).results, std::vector<std::string>{"y"});
  EXPECT_EQ(troubleIn([](std::size_t) { return std::string(std::string().max_size() + 1, 'x'); }).kind, Kind::kMemory);
}

TEST(ChildProcess, ASignalOfTheUserIsNoDamage) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    try {
      static_cast<void>(troubleIn([&](std::size_t) {
        raise(signal);
        return std::string();
      }));
      ADD_FAILURE() << "no error for signal " << signal;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kCancelled);
    }
  }
}

// An Error that takes the last memory with it when it is thrown, so that none is left for its words.
struct LastError : Error {
  LastError() : Error(Code::kIo, std::string(std::size_t{64} << 20, 'x'), "", "") {
    rlimit limit = {};
    getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = 0;
    setrlimit(RLIMIT_AS, &limit);
  }
};

// The child would else go on as a second copy of whoever called.
TEST(ChildProcess, NoExceptionLeavesTheChild) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer's shadow is larger than any limit";
#endif
  const SharedBuffer escaped(1);
  escaped.bytes()[0] = 'n';
  const pid_t parent = getpid();
  try {
    EXPECT_EQ(troubleIn([](std::size_t) -> std::string { throw LastError(); }).kind, Kind::kMemory);
  } catch (...) {
    if (getpid() == parent) throw;
    escaped.bytes()[0] = 'y';
    _exit(0);
  }
  EXPECT_EQ(escaped.bytes()[0], 'n');
}

// With `spare` descriptors that may still be opened.
class FewDescriptors {
 public:
  explicit FewDescriptors(int spare) {
    getrlimit(RLIMIT_NOFILE, &before_);
    const int next = dup(0);  // the lowest number that is free
    close(next);
    const rlimit few = {static_cast<rlim_t>(next + spare), before_.rlim_max};
    setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  FewDescriptors(const FewDescriptors&) = delete;
  FewDescriptors& operator=(const FewDescriptors&) = delete;

 private:
  rlimit before_ = {};
};

// At every limit, up to the first that is enough. Then the work has what it needs: four files at a time.
TEST(ChildProcess, SaysWhatIsMissingWhereTooFewFilesCanBeOpened) {
  int spare = 0;
  for (bool enough = false; !enough; ++spare) {
    ASSERT_LT(spare, 100);
    std::optional<Error> refusal;  // looked at with descriptors again: a sanitizer needs some
    try {
      const FewDescriptors few(spare);
      const ChildOutcome outcome = runInChild("scan.nii", 1, {}, [](std::size_t) {
        for (int i = 0; i < 4; ++i) {
          if (open("/dev/null", O_RDONLY) < 0) throw std::runtime_error("a library calls this damage");
        }
        return std::string();
      });
      enough = true;
      EXPECT_FALSE(outcome.trouble) << spare << ": " << outcome.trouble->words;
    } catch (const Error& error) {
      refusal = error;
    }
    if (!refusal) continue;
    EXPECT_EQ(refusal->code(), Error::Code::kIo);
    EXPECT_THAT(refusal->what(), testing::StartsWith("scan.nii: "));
    EXPECT_THAT(refusal->what(), testing::HasSubstr("Too many open files"));
    EXPECT_THAT(refusal->what(), testing::HasSubstr("ulimit -n"));
  }
  EXPECT_GT(spare, 2);  // it was not enough at first
}

TEST(ChildProcess, PrintsNothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  static_cast<void>(runInChild("file", 1, {}, [](std::size_t) {
    std::cout << "chatter" << std::endl;
    std::cerr << "chatter" << std::endl;
    return std::string();
  }));
  EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "");
}

TEST(ChildProcess, LimitsGrowWithTheFile) {
  const ChildLimits small = limitsForFile(1 << 20);
  EXPECT_EQ(small.cpu_s, 4);
  EXPECT_LE(small.memory_bytes, std::size_t{1} << 30);
  const ChildLimits large = limitsForFile(4e9, 2e9);
  EXPECT_GE(large.memory_bytes, 10e9);
  EXPECT_GE(large.cpu_s, 400);
}

}  // namespace child_process_test
}  // namespace palpate
