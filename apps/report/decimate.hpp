// SPDX-License-Identifier: Apache-2.0
// apps/report/decimate.hpp: reduces the rows of a plot without losing peaks.
//
// Any thread. Cost: one pass.
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

}  // namespace palpate
