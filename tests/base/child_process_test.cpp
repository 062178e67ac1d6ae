// SPDX-License-Identifier: Apache-2.0
#include "base/child_process.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/shared_buffer.hpp"
#include "tests/support/few_descriptors.hpp"

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

// Each piece once, in order, and none behind one that failed: the parent would not hear of it.
TEST(ChildProcess, DoesThePiecesUpToTheFirstThatFails) {
  const SharedBuffer done(4);
  const auto runPieces = [&](std::size_t failing) {
    std::fill(done.bytes().begin(), done.bytes().end(), '0');
    static_cast<void>(runInChild("file", 3, {}, [&](std::size_t n) {
      ++done.bytes()[n];
      if (n == failing) throw std::runtime_error("why");
      return std::string();
    }));
    return std::string(done.bytes().begin(), done.bytes().end());
  };
  EXPECT_EQ(runPieces(9), "1110");
  EXPECT_EQ(runPieces(1), "1100");
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

// As the system does where memory runs out.
TEST(ChildProcess, AKilledChildHadNoMemory) {
  const ChildTrouble trouble = troubleIn([](std::size_t) {
    raise(SIGKILL);
    return std::string();
  });
  EXPECT_EQ(trouble.kind, Kind::kMemory);
  EXPECT_THAT(trouble.words, testing::HasSubstr("it was killed"));
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

// Also where the caller blocks them.
TEST(ChildProcess, ASignalOfTheUserIsNoDamage) {
  sigset_t blocked, before;
  sigemptyset(&blocked);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, signal);
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
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
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

// Its parent is killed. Then the writing end of the pipe, which the child holds too, is closed: the child has ended. It
// would else wait ten minutes.
TEST(ChildProcess, DiesWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    ChildLimits limits;
    limits.cpu_s = 60;
    static_cast<void>(runInChild("file", 1, limits, [&](std::size_t) -> std::string {
      if (write(ends[1], "r", 1) == 1) {
        for (;;) pause();
      }
      return "";
    }));
    _exit(0);
  }
  close(ends[1]);
  char byte = 0;
  EXPECT_EQ(read(ends[0], &byte, 1), 1);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  EXPECT_EQ(read(ends[0], &byte, 1), 0);
  close(ends[0]);
}

// What the second piece of work sees of its limits, after a first that took 10 ms of the processor and less than 1 s.
// By default it has 4 s, counted in whole seconds from those that are spent, and the clock ends it ten times later.
TEST(ChildProcess, LimitsCountFromWhatIsSpent) {
  const int next = dup(STDERR_FILENO);  // the lowest number that is free
  close(next);
  ChildLimits limits;
  limits.memory_bytes = std::size_t{100} << 20;
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const ChildOutcome outcome = runInChild("file", 2, limits, [](std::size_t) {
    while (std::clock() < CLOCKS_PER_SEC / 100) {
    }
    rlimit cpu = {}, memory = {}, core = {};
    getrlimit(RLIMIT_CPU, &cpu);
    getrlimit(RLIMIT_AS, &memory);
    getrlimit(RLIMIT_CORE, &core);
    const unsigned left_s = alarm(0);
    const int free = dup(STDERR_FILENO);
    close(free);
    return fmt::format("{} {} {} {} {} {}", cpu.rlim_cur, memory.rlim_cur, core.rlim_cur, core.rlim_max, left_s, free);
  });
  ASSERT_EQ(outcome.results.size(), 2U);
  std::istringstream words(outcome.results[1]);
  std::uint64_t cpu_s = 0, memory_bytes = 0, core = 1, most_core = 1, left_s = 0;
  int free = 0;
  words >> cpu_s >> memory_bytes >> core >> most_core >> left_s >> free;
  EXPECT_EQ(cpu_s, 5U);  // 4 and a part of one
  EXPECT_LE(left_s, 40U);
  EXPECT_GE(left_s, 20U);
  EXPECT_EQ(core, 0U);
  EXPECT_EQ(most_core, 0U);
  EXPECT_EQ(free, next);  // nothing is left open: the pipe's reading end, which the child closes, had that number
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // The caller may have asked the system for a little more in between.
  const double expected = static_cast<double>(pages * sysconf(_SC_PAGESIZE) + limits.memory_bytes);
  EXPECT_NEAR(static_cast<double>(memory_bytes), expected, 1 << 20);
#endif
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
  EXPECT_EQ(limitsForFile(1000, 24).memory_bytes, (std::size_t{512} << 20) + 2024);
  EXPECT_EQ(limitsForFile(10 * 4.0 * (1 << 20)).cpu_s, 14);
  EXPECT_EQ(limitsForFile(10 * 4.0 * (1 << 20) - 1).cpu_s, 13);
}

}  // namespace child_process_test
}  // namespace palpate
