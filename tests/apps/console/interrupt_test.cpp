// SPDX-License-Identifier: Apache-2.0
// No time is asserted: what must not end lives until the test lets it go, what must end is waited for.
#include "apps/console/interrupt.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/atomic_file.hpp"
#include "base/error.hpp"
#include "in_child.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace interrupt_test {

constexpr useconds_t kMoreThanPatience_us = 400'000;
constexpr useconds_t kMoreThanOneRequest_us = 600'000;

class Interrupts : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }
  void mark(const std::string& name) const { std::ofstream(file(name)) << name; }
  void waitFor(const std::string& name) const {
    for (int looks = 0; looks < 60'000 && !std::filesystem::exists(file(name)); ++looks) usleep(1000);
  }
  // Work that looks at nothing, as a library's does.
  [[noreturn]] void beStuck() const {
    mark("ready");
    for (;;) pause();
  }
  [[nodiscard]] auto sends(const std::vector<int>& signals) const {
    return [this, signals](pid_t child) {
      waitFor("ready");
      for (const int signal : signals) {
        kill(child, signal);
        if (&signal != &signals.back()) usleep(kMoreThanOneRequest_us);
      }
    };
  }
  TemporaryFolder folder_;
};

TEST_F(Interrupts, OnlySetAFlagAtFirst) {
  const Ended ended = inChild([&] {
    catchInterrupts();
    if (interrupted()) _exit(4);
    throwIfInterrupted("palpate test");
    raise(SIGINT);
    if (!interrupted()) _exit(1);
    try {
      throwIfInterrupted("palpate test", "half of it is there");
    } catch (const Error& error) {
      const std::string what = error.what();
      _exit(what == "palpate test: stopped by the user; half of it is there" ? exitStatus(error.code()) : 2);
    }
    _exit(3);
  });
  EXPECT_EQ(ended.status, 130);
  EXPECT_EQ(ended.err, "");
}

TEST_F(Interrupts, EndWorkThatDoesNotLook) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::filesystem::remove(file("ready"));
    const Ended ended = inChild(
        [&] {
          catchInterrupts();
          nameWork("palpate test");
          static AtomicFile unfinished(file("a.vdb"));
          unfinished.write(std::string(100'000, 'u'));
          beStuck();
        },
        sends({signal}));
    EXPECT_EQ(ended.status, 130) << signal;
    EXPECT_EQ(ended.err, "palpate: palpate test: stopped by the user; nothing was written; start it again\n");
    EXPECT_EQ(folder_.files(), 1);  // that it was ready
  }
}

// What is said of the work is true: a file that was finished is not "nothing".
TEST_F(Interrupts, TellWhatIsThere) {
  Ended ended = inChild(
      [&] {
        catchInterrupts();
        writeFileAtomically(file("a.vdb"), "whole");
        beStuck();
      },
      sends({SIGINT}));
  EXPECT_THAT(ended.err,
              testing::HasSubstr("; the files that it had finished are there; start it again for the rest\n"));
  std::filesystem::remove(file("ready"));
  ended = inChild(
      [&] {
        catchInterrupts();
        tellWhatIsKept("the journal holds it all");
        beStuck();
      },
      sends({SIGINT}));
  EXPECT_THAT(ended.err, testing::HasSubstr("stopped by the user; the journal holds it all\n"));
}

TEST_F(Interrupts, LetWorkThatHasSomethingToKeepGoOn) {
  const Ended ended = inChild(
      [&] {
        catchInterrupts();
        const KeptWork kept;
        mark("ready");
        while (!interrupted()) usleep(1000);
        usleep(kMoreThanPatience_us);
        _exit(7);
      },
      sends({SIGINT}));
  EXPECT_EQ(ended.status, 7);
  EXPECT_EQ(ended.err, "");
}

// Once it is kept, the process has no more time than any other.
TEST_F(Interrupts, EndWorkThatIsStuckAfterItKeptWhatThereWas) {
  const Ended ended = inChild(
      [&] {
        catchInterrupts();
        {
          const KeptWork kept;
          mark("ready");
          while (!interrupted()) usleep(1000);
        }
        for (;;) pause();
      },
      sends({SIGINT}));
  EXPECT_EQ(ended.status, 130);
}

TEST_F(Interrupts, TheSecondRequestEndsThatWorkToo) {
  const Ended ended = inChild(
      [&] {
        catchInterrupts();
        const KeptWork kept;
        static AtomicFile unfinished(file("a.vdb"));
        mark("ready");
        while (!interrupted()) usleep(1000);
        mark("heard");
        for (;;) pause();
      },
      [this](pid_t child) {
        waitFor("ready");
        kill(child, SIGINT);
        waitFor("heard");
        usleep(kMoreThanOneRequest_us);
        kill(child, SIGINT);
      });
  EXPECT_EQ(ended.status, 130);
  EXPECT_THAT(ended.err, testing::HasSubstr("nothing was written"));
  EXPECT_EQ(folder_.files(), 2);
}

// `timeout` signals its child and then the child's group.
TEST_F(Interrupts, ThatComeTwiceAtOnceAreOne) {
  const Ended ended = inChild([&] {
    catchInterrupts();
    const KeptWork kept;
    raise(SIGTERM);
    raise(SIGTERM);
    usleep(kMoreThanPatience_us);
    _exit(7);
  });
  EXPECT_EQ(ended.status, 7);
}

// `nohup palpate ...` outlives its terminal. A script's background job ignores SIGINT, but not a SIGINT that is sent to
// it.
TEST_F(Interrupts, KeepAHangUpThatWasIgnored) {
  const Ended ended = inChild([&] {
    for (const int signal : {SIGHUP, SIGINT}) std::signal(signal, SIG_IGN);
    catchInterrupts();
    raise(SIGHUP);
    if (interrupted()) _exit(1);
    raise(SIGINT);
    _exit(interrupted() ? 0 : 2);
  });
  EXPECT_EQ(ended.status, 0);
}

// main() has said how it ended; a request then changes neither status nor words.
TEST_F(Interrupts, AfterTheWorkSayNothing) {
  const Ended ended = inChild(
      [&] {
        catchInterrupts();
        endOfWork(4);
        beStuck();
      },
      sends({SIGINT}));
  EXPECT_EQ(ended.status, 4);
  EXPECT_EQ(ended.err, "");
}

TEST_F(Interrupts, AClosedPipeIsAnErrorOfItsWriter) {
  const Ended ended = inChild([] {
    catchInterrupts();
    int ends[2];
    if (pipe(ends) != 0) _exit(1);
    close(ends[0]);
    _exit(write(ends[1], "x", 1) < 0 && errno == EPIPE ? 0 : 2);
  });
  EXPECT_EQ(ended.status, 0);
}

}  // namespace interrupt_test
}  // namespace palpate
