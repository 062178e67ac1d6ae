// SPDX-License-Identifier: Apache-2.0
// In a child process each where it is about what signals do to a process.
#include "apps/supervise/signal_inbox.hpp"

#include <optional>

#include <gmock/gmock.h>

#include "apps/console/interrupt.hpp"
#include "refusal.hpp"
#include "tests/apps/console/in_child.hpp"

namespace palpate {
namespace signal_inbox_test {

using testing::HasSubstr;

constexpr int kForEver = -1, kNotAtAll = 0;

TEST(SignalInbox, KeepsEachSignalUntilItIsTaken) {
  SignalInbox inbox;
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGCHLD}) {
    EXPECT_EQ(inbox.take(signal), 0) << signal;
    raise(signal);
    inbox.wait(kForEver);
    EXPECT_EQ(inbox.take(signal), 1) << signal;
    EXPECT_EQ(inbox.take(signal), 0) << signal;
  }
  raise(SIGTERM);
  raise(SIGCHLD);
  inbox.wait(kForEver);
  inbox.wait(kNotAtAll);
  EXPECT_EQ(inbox.take(SIGCHLD), 1);
  EXPECT_EQ(inbox.take(SIGTERM), 1);
  EXPECT_EQ(inbox.take(SIGINT), 0);
}

TEST(SignalInbox, BeginsEmpty) {
  std::optional<SignalInbox> first(std::in_place);
  raise(SIGINT);
  first.reset();
  SignalInbox second;
  EXPECT_EQ(second.take(SIGINT), 0);
}

TEST(SignalInbox, IsTheOnlyOne) {
  const SignalInbox first;
  EXPECT_THAT(refusalOf([] { const SignalInbox second; }), HasSubstr("supervises others already"));
}

TEST(SignalInbox, GivesTheSignalsBack) {
  const Ended ended = inChild([] {
    { const SignalInbox inbox; }
    raise(SIGTERM);
  });
  EXPECT_EQ(ended.signal, SIGTERM);
}

TEST(SignalInbox, TakesRequestsToStopForItsTimeOnly) {
  const Ended ended = inChild([] {
    catchInterrupts();
    const KeptWork work;
    {
      const SignalInbox inbox;
      raise(SIGTERM);
      raise(SIGHUP);
    }
    if (interrupted()) _exit(4);
    raise(SIGTERM);
    _exit(interrupted() ? 0 : 5);
  });
  EXPECT_EQ(ended.status, 0);
}

TEST(SignalInbox, LeavesAnIgnoredHangUpIgnored) {
  const Ended ended = inChild([] {
    static_cast<void>(std::signal(SIGHUP, SIG_IGN));
    SignalInbox inbox;
    raise(SIGHUP);
    inbox.wait(kNotAtAll);
    _exit(inbox.take(SIGHUP));
  });
  EXPECT_EQ(ended.status, 0);
}

}  // namespace signal_inbox_test
}  // namespace palpate
