// SPDX-License-Identifier: Apache-2.0
// base/monotonic_clock.hpp: the clock of servo, engine and devices. Any thread; no system call where the vDSO serves
// it.
#pragma once

#include <cstdint>

#include <time.h>

namespace palpate {

// CLOCK_MONOTONIC [ns].
[[nodiscard]] inline std::int64_t monotonicNow_ns() noexcept {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerS + now.tv_nsec;
}

// How long the machine has slept since it was started, when the clock above stood still [ns]: to some microseconds.
[[nodiscard]] inline std::int64_t suspended_ns() noexcept {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  std::int64_t shortest_ns = 0, slept_ns = 0;
  for (int look = 0; look < 3; ++look) {  // whoever is interrupted between two clocks takes long
    const std::int64_t before_ns = monotonicNow_ns();
    timespec now{};
    clock_gettime(CLOCK_BOOTTIME, &now);
    const std::int64_t took_ns = monotonicNow_ns() - before_ns;
    if (look > 0 && took_ns >= shortest_ns) continue;
    shortest_ns = took_ns;
    slept_ns = now.tv_sec * kNsPerS + now.tv_nsec - before_ns;
  }
  return slept_ns;
}

}  // namespace palpate
