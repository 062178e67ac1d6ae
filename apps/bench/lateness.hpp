// SPDX-License-Identifier: Apache-2.0
// apps/bench/lateness.hpp: counts how late a thread wakes up, as cyclictest counts it, and runs cyclictest itself
// (Debian package rt-tests), the usual measure of a machine's real-time performance.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

// A histogram with classes of a microsecond: class i counts wake-ups that were late by [i, i + 1) us. Any thread.
class LatenessCounts {
 public:
  static constexpr std::int64_t kOverflow_us = 100000;  // the last class: this late or later

  void add(std::int64_t lateness_us, std::int64_t times = 1);
  void add(const LatenessCounts& other);

  [[nodiscard]] std::int64_t total() const noexcept { return total_; }
  // The quantile as in base/quantile.hpp: the lowest class that at least the fraction q (0..1) does not exceed [us].
  [[nodiscard]] double quantile_us(double q) const;
  // The number of wake-ups in classes from `us` on.
  [[nodiscard]] std::int64_t atLeast(std::int64_t us) const;
  // The number of wake-ups that were late by a period or more, in whole microseconds.
  [[nodiscard]] std::int64_t misses(double rate_hz) const;

 private:
  std::vector<std::int64_t> counts_;  // by class, up to the latest class seen
  std::int64_t total_ = 0;
};

// Cyclictest sleeps and wakes as the servo does: one thread, clock_nanosleep until absolute times of CLOCK_MONOTONIC,
// SCHED_FIFO at the same priority, locked memory, no affinity. With --default-system it does not ask the processors to
// stay out of power saving; neither does the servo. Its lateness is truncated to whole microseconds.
struct CyclictestRequest {
  double rate_hz = 1000;
  std::int64_t cycles = 1000;
  int priority = 80;
  bool fifo = true;  // false: ordinary priority, for a machine where the servo gets no other
};

struct CyclictestOutcome {
  LatenessCounts lateness;
  std::string trouble;  // why there are no figures; empty: there are
};

// Runs cyclictest and blocks until it ends. Throws Error(kCancelled) on Ctrl-C.
[[nodiscard]] CyclictestOutcome runCyclictest(const CyclictestRequest& request);

// The command that runCyclictest() gives to the shell.
[[nodiscard]] std::string cyclictestCommand(const CyclictestRequest& request);

// Parses the output of `cyclictest -q -h`: lines "000012 000345" (microseconds, count), and "# Histogram Overflows:
// 00002". Empty if there is no such line.
[[nodiscard]] std::optional<LatenessCounts> parseCyclictest(const std::string& text);

}  // namespace palpate
