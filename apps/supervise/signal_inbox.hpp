// SPDX-License-Identifier: Apache-2.0
// apps/supervise/signal_inbox.hpp: signals as something that poll(2) waits for. Linux only.
//
// While an inbox exists, SIGTERM, SIGINT, SIGHUP and SIGCHLD go into it, whichever thread they reach. So they are no
// requests to stop for apps/console/interrupt.hpp in that time; afterwards they are again. SIGHUP stays ignored where
// it is (nohup). A signalfd would not do: it needs the signals blocked in every thread, and the program has others.
// Threads: the set-up thread. Cost: some system calls. One inbox at a time.
#pragma once

#include <array>

#include <signal.h>

namespace palpate {

class SignalInbox {
 public:
  SignalInbox();   // throws Error: kBadInput if there is an inbox already, kIo if no descriptor is left
  ~SignalInbox();  // what was done with these signals before is done again
  SignalInbox(const SignalInbox&) = delete;
  SignalInbox& operator=(const SignalInbox&) = delete;

  // Waits for a signal for `most_ms` at most [ms]; below 0: without an end.
  void wait(int most_ms) noexcept;
  // How often the signal, one of the four, came since the last call. Several of one kind may come as one.
  [[nodiscard]] int take(int signal) noexcept;

 private:
  std::array<struct sigaction, 4> before_;
};

}  // namespace palpate
