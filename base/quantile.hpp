// SPDX-License-Identifier: Apache-2.0
// base/quantile.hpp: quantiles of measured values, all by one rule.
//
// Any thread. Cost: one sort. The values must not contain NaN.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

struct Percentiles {
  std::size_t count = 0;  // of values; with 0 all figures are 0
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
};

// Element ceil(q n) of the sorted list, `q` from 0 to 1: the smallest value that at least the share q of all values
// does not exceed. Nothing is interpolated, so each figure was really measured. `sorted` is ascending; if it is empty,
// the result is 0.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double q);

[[nodiscard]] Percentiles percentiles(std::vector<double> values);

// The middle value, or the mean of the two in the middle. `values` may not be empty.
[[nodiscard]] double median(std::vector<double> values);

}  // namespace palpate
