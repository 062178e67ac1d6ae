// SPDX-License-Identifier: Apache-2.0
// apps/supervise/service_notify.hpp: tells systemd how a service is, by the protocol of sd_notify(3).
//
// systemd names a datagram socket in the environment variable NOTIFY_SOCKET: a path, or '@' and a name of the kernel's
// (an abstract socket). Where the variable is not set, everything here does nothing, so a caller need not ask. With
// Type=notify systemd waits for ready() and starts what comes after the service then. libsystemd is not needed for it.
// A child inherits the variable; systemd listens to children only with NotifyAccess=all.
// Threads: any, one at a time. Each call is some system calls, and waits for room in the socket for a second at most.
// Not for the servo's thread. Linux only.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

class ServiceNotify {
 public:
  // As the environment says. Throws Error(kBadInput) for a NOTIFY_SOCKET that is no address of a Unix socket, and for a
  // WATCHDOG_USEC or WATCHDOG_PID that is no number.
  ServiceNotify();

  [[nodiscard]] bool isWanted() const noexcept { return !address_.empty(); }

  // Each is true if the message went out; false if none is wanted, or nobody listens. A service goes on either way.
  bool ready() const noexcept;                        // after its start, and after reloading()
  bool reloading() const noexcept;                    // it reads its settings anew; ready() ends that
  bool stopping() const noexcept;                     // it ends, in good order
  bool status(std::string_view text) const noexcept;  // for `systemctl status`; control characters become '?'
  bool watchdog() const noexcept;                     // it lives; see watchdogPeriod()

  // If this process is to call watchdog(): how long systemd waits for it (WatchdogSec) before it ends the service. Call
  // it twice as often.
  [[nodiscard]] std::optional<std::chrono::microseconds> watchdogPeriod() const noexcept { return watchdog_period_; }

 private:
  bool send(std::string_view message) const noexcept;

  std::string address_;  // as NOTIFY_SOCKET has it; empty: not wanted
  std::optional<std::chrono::microseconds> watchdog_period_;
};

}  // namespace palpate
