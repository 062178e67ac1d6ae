// SPDX-License-Identifier: Apache-2.0
// apps/report/plot_data.hpp: the data of plots: curves reduced to few rows without losing peaks, and histograms of
// times with classes of equal width on a logarithmic axis. Any thread. Cost: one pass.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

// Columns over a common axis: time_s[i] belongs to series[k][i] for each k. NaN is a gap.
struct PlotTable {
  std::vector<double> time_s;
  std::vector<std::vector<double>> series;
};

// At most 2 * buckets rows. Each bucket of neighbouring rows becomes two rows: with its first and its last time, and
// for each series its smallest and largest value in the order in which they occurred. A short table is returned
// unchanged.
[[nodiscard]] PlotTable decimate(const PlotTable& table, std::size_t buckets);

// A histogram on a logarithmic axis.
struct LogHistogram {
  double low = 0;    // lower edge of the first class; in the values' unit
  double ratio = 1;  // upper edge / lower edge of each class [-]
  std::vector<std::size_t> counts;
  std::size_t below = 0;                           // values at or below zero, which have no logarithm
  [[nodiscard]] double edge(std::size_t i) const;  // lower edge of class i
};

// `per_decade` classes for each factor of ten, from the decade of the smallest positive value to that of the largest,
// but over at most six decades: smaller values go to the first class. Values may not be NaN.
[[nodiscard]] LogHistogram logHistogram(const std::vector<double>& values, int per_decade);

}  // namespace palpate
