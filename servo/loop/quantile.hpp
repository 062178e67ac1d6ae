// SPDX-License-Identifier: Apache-2.0
// servo/loop/quantile.hpp: quantiles of measured values, by one stated rule, and the usual five of them.
//
// Any thread. Cost: one sort. NaN may not be among the values.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

struct Percentiles {
  std::size_t count = 0;  // of values; with 0 all figures are 0
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
};

// The smallest value that at least the share `q` (0..1) of all values does not exceed: element ceil(q n) of the sorted
// list, no interpolation, so each figure was really measured. `sorted` ascending; 0 if it is empty.
[[nodiscard]] double quantile(const std::vector<double>& sorted, double q);

[[nodiscard]] Percentiles percentiles(std::vector<double> values);

}  // namespace palpate
