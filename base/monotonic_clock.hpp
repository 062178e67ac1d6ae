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

}  // namespace palpate
