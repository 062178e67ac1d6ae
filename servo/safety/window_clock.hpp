// SPDX-License-Identifier: Apache-2.0
// servo/safety/window_clock.hpp: how long ago the window was last confirmed, and whether that can be known.
//
// The age of a window is the servo's time less the time of the engine's last confirmation. It means nothing if one of
// the two clocks steps. Two signs of a step raise kClockStep. The servo's time or the confirmation goes backwards: for
// one tick. Or the confirmation lies in the servo's future: until the servo's time or the engine has caught up. A servo
// clock that steps forward looks the same as a servo that stood still. So it counts as a stall (safety_gate.hpp), and
// the window is stale until the engine confirms it again.
// Without any step a confirmation may be a little in the future. The servo may be preempted between reading the clock
// and reading the confirmation. Up to the stall time this counts as fresh.
// Thread: the servo's. Cost: a few comparisons. Errors, heap: none. Times [ns].
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "servo/safety/faults.hpp"

namespace palpate {

class WindowClock {
 public:
  struct Reading {
    std::int64_t age_ns = 0;   // never negative; 0 without a window
    std::uint32_t faults = 0;  // kClockStep or none
  };

  explicit WindowClock(std::int64_t future_tolerance_ns) noexcept : tolerance_ns_(future_tolerance_ns) {}

  // Call once per tick. `confirmed_ns` was read before the window (window_exchange.hpp). `version` and `stamp_ns` are
  // the window's; version 0: there is no window.
  [[nodiscard]] Reading read(std::int64_t now_ns, std::int64_t confirmed_ns, std::uint64_t version,
                             std::int64_t stamp_ns) noexcept {
    bool step = now_ns < last_now_ns_;
    last_now_ns_ = now_ns;
    if (confirmed_ns != last_confirmed_ns_) {
      step = step || confirmed_ns < last_confirmed_ns_;
      last_confirmed_ns_ = known_ns_ = confirmed_ns;
    }
    if (version != last_version_) {
      // Publishing confirms a window at its stamp, but that may have happened after `confirmed_ns` was read.
      last_version_ = version;
      known_ns_ = std::max(known_ns_, stamp_ns);
    }
    if (version == 0) return {0, stepBit(step)};
    std::int64_t age_ns = 0;
    const bool known = !__builtin_sub_overflow(now_ns, known_ns_, &age_ns) && age_ns >= -tolerance_ns_;
    return {known && age_ns > 0 ? age_ns : 0, stepBit(step || !known)};
  }

 private:
  static constexpr std::int64_t kLongAgo_ns = std::numeric_limits<std::int64_t>::min();
  static constexpr std::uint32_t stepBit(bool step) noexcept { return step ? bit(ServoFault::kClockStep) : 0; }

  std::int64_t tolerance_ns_;
  std::int64_t last_now_ns_ = kLongAgo_ns;
  std::int64_t last_confirmed_ns_ = kLongAgo_ns;
  std::int64_t known_ns_ = kLongAgo_ns;  // the latest time at which the window was known to hold
  std::uint64_t last_version_ = 0;
};

}  // namespace palpate
