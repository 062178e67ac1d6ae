// SPDX-License-Identifier: Apache-2.0
// apps/report/histogram.hpp: a histogram of times, with classes of equal width on a logarithmic axis.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

struct LogHistogram {
  double low = 0;    // lower edge of the first class; in the values' unit
  double ratio = 1;  // upper edge / lower edge of each class [-]
  std::vector<std::size_t> counts;
  std::size_t below = 0;                           // values at or below zero, which have no logarithm
  [[nodiscard]] double edge(std::size_t i) const;  // lower edge of class i
};

// `per_decade` classes for each factor of ten, from the decade of the smallest positive value to that of the largest,
// but over at most six decades: smaller values go to the first class. Values may not be NaN. Any thread; one pass.
[[nodiscard]] LogHistogram logHistogram(const std::vector<double>& values, int per_decade);

}  // namespace palpate
