// SPDX-License-Identifier: Apache-2.0
#include "base/quantile.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

namespace {

// The index of the quantile among `count` sorted values; `count` is not 0.
std::size_t placeOf(double q, std::size_t count) {
  // 0.55 * 100 is a little above 55 in binary. Without the small allowance this would give element 56.
  const double rank = std::ceil(std::clamp(q, 0.0, 1.0) * static_cast<double>(count) * (1 - 1e-12));
  return static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
}

}  // namespace

double quantile(const std::vector<double>& sorted, double q) {
  return sorted.empty() ? 0 : sorted[placeOf(q, sorted.size())];
}

// Selects each quantile without a full sort: it is searched among the values that are not below the quantile before it.
Percentiles percentiles(std::vector<double> values) {
  Percentiles found;
  found.count = values.size();
  if (values.empty()) return found;
  auto from = values.begin();
  for (const auto& [q, value] :
       {std::pair(0.5, &Percentiles::p50), std::pair(0.9, &Percentiles::p90), std::pair(0.99, &Percentiles::p99),
        std::pair(0.999, &Percentiles::p999), std::pair(1.0, &Percentiles::max)}) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(placeOf(q, values.size()));
    std::nth_element(from, at, values.end());
    found.*value = *at;
    from = at;
  }
  return found;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

}  // namespace palpate
