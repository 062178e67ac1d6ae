// SPDX-License-Identifier: Apache-2.0
// apps/bench/lateness.hpp: how late wake-ups came, counted as cyclictest (Debian package rt-tests) counts them, and
// cyclictest itself, the measure of what a machine can do in real time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

// In classes of a microsecond: a class holds what was late by [i, i + 1) us; what is later than the last class is an
// overflow and counts as kOverflow_us. Any thread.
class LatenessCounts {
 public:
  static constexpr std::int64_t kOverflow_us = 100000;  // and later

  void add(std::int64_t lateness_us, std::int64_t times = 1);
  void add(const LatenessCounts& other);

  [[nodiscard]] std::int64_t total() const noexcept { return total_; }
  // As in base/quantile.hpp: the class that at least the share q (0..1) of all does not exceed [us].
  [[nodiscard]] double quantile_us(double q) const;
  // In classes that begin at or behind `us`.
  [[nodiscard]] std::int64_t atLeast(std::int64_t us) const;
  // A class begins behind a period: more than that late.
  [[nodiscard]] std::int64_t misses(double rate_hz) const;

 private:
  std::vector<std::int64_t> counts_;  // as long as the latest class seen
  std::int64_t total_ = 0;
};

// Cyclictest sleeps and wakes as the servo does: one thread, clock_nanosleep until absolute times of CLOCK_MONOTONIC,
// SCHED_FIFO at the same priority, memory locked, no affinity, and, by --default-system, no request to keep processors
// out of power saving, which the servo does not make either. Its lateness is in whole microseconds, cut down.
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

// The caller's thread waits for it. Throws Error(kCancelled) on Ctrl-C.
[[nodiscard]] CyclictestOutcome runCyclictest(const CyclictestRequest& request);

// The command that runCyclictest() gives to the shell.
[[nodiscard]] std::string cyclictestCommand(const CyclictestRequest& request);

// What `cyclictest -q -h` prints: lines "000012 000345" (microseconds, times), and "# Histogram Overflows: 00002".
// Nothing if there is no such line.
[[nodiscard]] std::optional<LatenessCounts> parseCyclictest(const std::string& text);

}  // namespace palpate
