// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/quantile.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

double quantile(const std::vector<double>& sorted, double q) {
  if (sorted.empty()) return 0;
  const double count = static_cast<double>(sorted.size());
  // 0.55 * 100 is a little above 55 in binary: without the small allowance it would name element 56.
  const double rank = std::ceil(std::clamp(q, 0.0, 1.0) * count * (1 - 1e-12));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

Percentiles percentiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {.count = values.size(),
          .p50 = quantile(values, 0.5),
          .p90 = quantile(values, 0.9),
          .p99 = quantile(values, 0.99),
          .p999 = quantile(values, 0.999),
          .max = quantile(values, 1)};
}

}  // namespace palpate
