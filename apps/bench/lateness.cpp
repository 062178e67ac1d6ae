// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/lateness.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {

void LatenessCounts::add(std::int64_t lateness_us, std::int64_t times) {
  const auto at = static_cast<std::size_t>(std::clamp<std::int64_t>(lateness_us, 0, kOverflow_us));
  if (counts_.size() <= at) counts_.resize(at + 1);
  counts_[at] += times;
  total_ += times;
}

void LatenessCounts::add(const LatenessCounts& other) {
  for (std::size_t i = 0; i < other.counts_.size(); ++i) {
    if (other.counts_[i] > 0) add(static_cast<std::int64_t>(i), other.counts_[i]);
  }
}

double LatenessCounts::quantile_us(double q) const {
  const double rank = std::max(1.0, std::ceil(q * static_cast<double>(total_) * (1 - 1e-12)));
  double seen = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    seen += static_cast<double>(counts_[i]);
    if (seen >= rank) return static_cast<double>(i);
  }
  return 0;
}

std::int64_t LatenessCounts::atLeast(std::int64_t us) const {
  if (us >= static_cast<std::int64_t>(counts_.size())) return 0;
  return std::accumulate(counts_.begin() + std::max<std::int64_t>(us, 0), counts_.end(), std::int64_t{0});
}

std::int64_t LatenessCounts::misses(double rate_hz) const {
  return atLeast(static_cast<std::int64_t>(std::ceil(1e6 / rate_hz)));
}

}  // namespace palpate
