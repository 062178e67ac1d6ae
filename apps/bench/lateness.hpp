// SPDX-License-Identifier: Apache-2.0
// apps/bench/lateness.hpp: how late wake-ups came, counted in classes of a microsecond, as cyclictest counts them.
//
// A class holds what was late by [i, i + 1) us; what is later than the last class is an overflow and counts as
// kOverflow_us. Any thread.
#pragma once

#include <cstdint>
#include <vector>

namespace palpate {

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

}  // namespace palpate
