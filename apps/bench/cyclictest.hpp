// SPDX-License-Identifier: Apache-2.0
// apps/bench/cyclictest.hpp: runs cyclictest (Debian package rt-tests), the measure of what a machine can do in real
// time.
//
// It sleeps and wakes as the servo does: one thread, clock_nanosleep until absolute times of CLOCK_MONOTONIC,
// SCHED_FIFO at the same priority, memory locked, no affinity, and, by --default-system, no request to keep processors
// out of power saving, which the servo does not make either. Its lateness is in whole microseconds, cut down. The
// caller's thread waits for it.
#pragma once

#include <optional>
#include <string>

#include "apps/bench/lateness.hpp"

namespace palpate {

struct CyclictestRequest {
  double rate_hz = 1000;
  std::int64_t cycles = 1000;
  int priority = 80;
  bool fifo = true;  // false: ordinary priority, where the servo has no other
};

struct CyclictestOutcome {
  LatenessCounts lateness;
  std::string trouble;  // why there is nothing; empty: all went well
};

[[nodiscard]] CyclictestOutcome runCyclictest(const CyclictestRequest& request);

// The command that runCyclictest() gives to the shell.
[[nodiscard]] std::string cyclictestCommand(const CyclictestRequest& request);

// What `cyclictest -q -h` prints: lines "000012 000345" (microseconds, times), and "# Histogram Overflows: 00002".
// Nothing if there is no such line.
[[nodiscard]] std::optional<LatenessCounts> parseCyclictest(const std::string& text);

}  // namespace palpate
