// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/real_time.hpp"

#include <cerrno>
#include <system_error>
#include <thread>

#include <sched.h>
#include <sys/mman.h>
#include <time.h>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;

std::string reason(int error) {
  return std::generic_category().message(error);
}

}  // namespace

RealTimeStatus becomeRealTime(int priority) {
  RealTimeStatus status;
  status.asked = true;
  sched_param wanted{};
  wanted.sched_priority = priority;
  // 0: this thread. A servo may not name threads here, not even its own (service/sandbox).
  status.fifo = sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
  if (!status.fifo) {
    status.notes.push_back(
        formatted("no real-time priority (SCHED_FIFO {}): {}; allow rtprio {} or more for the user in "
                  "/etc/security/limits.conf, or expect more late ticks",
                  priority, reason(errno), priority));
  }
  // On fault: pages that are not in use yet, such as those of other threads' stacks, are not loaded.
  status.memory_locked = mlockall(MCL_CURRENT | MCL_ONFAULT) == 0;
  if (!status.memory_locked) {
    status.notes.push_back(
        formatted("memory not locked: {}; raise memlock for the user in /etc/security/limits.conf, "
                  "or expect a late tick where a page was swapped out",
                  reason(errno)));
  }
  return status;
}

void refuseWithoutRealTime(const RealTimeStatus& status) {
  if (status.granted()) return;
  throw Error(Error::Code::kDevice, "real time", listed(status.notes, "; "), "or leave --require-real-time out");
}

void checkRealTime(int priority) {
  RealTimeStatus status;
  std::thread([&] { status = becomeRealTime(priority); }).join();
  munlockall();
  refuseWithoutRealTime(status);
}

void sleepUntil(std::int64_t due_ns) noexcept {
  timespec due{};
  due.tv_sec = due_ns / kNsPerS;
  due.tv_nsec = due_ns % kNsPerS;
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
}

}  // namespace palpate
