// SPDX-License-Identifier: Apache-2.0
// servo/loop/real_time.hpp: what the servo thread asks of the system before its first tick, and its sleep.
//
// What the system refuses is noted with reason and remedy, and the loop goes on. Thread: the servo's, for itself. Cost:
// becomeRealTime() makes system calls, so call it before the first tick only. sleepUntil() is for every
// tick.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/monotonic_clock.hpp"

namespace palpate {

struct RealTimeStatus {
  bool asked = false;              // false with the simulated clock, or if the caller did not want it
  bool fifo = false;               // runs under SCHED_FIFO
  bool memory_locked = false;      // the pages that the process has now stay in memory
  std::vector<std::string> notes;  // for each thing refused: what, why, what to do
  [[nodiscard]] bool granted() const noexcept { return fifo && memory_locked; }
};

// Asks for SCHED_FIFO at `priority` (1 to 99) for the calling thread, and locks the memory that the process has now.
// Memory that is allocated later is not locked: if locked memory is limited, allocations of other threads would fail.
[[nodiscard]] RealTimeStatus becomeRealTime(int priority);

// Throws Error(kDevice) with the notes unless all was granted.
void refuseWithoutRealTime(const RealTimeStatus& status);
// Asks in a thread that ends at once, and throws as refuseWithoutRealTime(). For a job that begins with minutes of
// other work. No memory stays locked.
void checkRealTime(int priority);

// Sleeps until `due_ns` on the monotonic clock; returns at once if it has passed. Signals do not end it early.
void sleepUntil(std::int64_t due_ns) noexcept;

}  // namespace palpate
