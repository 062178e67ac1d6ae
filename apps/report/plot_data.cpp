// SPDX-License-Identifier: Apache-2.0
#include "apps/report/plot_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

constexpr double kMostDecades = 6;  // of a histogram

// Smallest and largest of v[begin, end), the earlier one first; NaN only where all are.
std::pair<double, double> extremes(const std::vector<double>& v, std::size_t begin, std::size_t end) {
  std::size_t low = end, high = end;
  for (std::size_t i = begin; i < end; ++i) {
    if (std::isnan(v[i])) continue;
    if (low == end || v[i] < v[low]) low = i;
    if (high == end || v[i] > v[high]) high = i;
  }
  if (low == end) return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  return low <= high ? std::pair(v[low], v[high]) : std::pair(v[high], v[low]);
}

}  // namespace

PlotTable decimate(const PlotTable& table, std::size_t buckets) {
  const std::size_t rows = table.time_s.size();
  if (rows <= 2 * buckets) return table;
  PlotTable out;
  out.series.resize(table.series.size());
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const std::size_t begin = bucket * rows / buckets, end = (bucket + 1) * rows / buckets;
    out.time_s.push_back(table.time_s[begin]);
    out.time_s.push_back(table.time_s[end - 1]);
    for (std::size_t k = 0; k < table.series.size(); ++k) {
      const auto [first, second] = extremes(table.series[k], begin, end);
      out.series[k].push_back(first);
      out.series[k].push_back(second);
    }
  }
  return out;
}

double LogHistogram::edge(std::size_t i) const {
  return low * std::pow(ratio, static_cast<double>(i));
}

LogHistogram logHistogram(const std::vector<double>& values, int per_decade) {
  LogHistogram out;
  double smallest = 0, largest = 0;
  for (const double v : values) {
    if (v <= 0) continue;
    smallest = smallest > 0 ? std::min(smallest, v) : v;
    largest = std::max(largest, v);
  }
  out.ratio = std::pow(10.0, 1.0 / per_decade);
  if (largest > 0) {
    const double top = std::floor(std::log10(largest)) + 1;
    const double bottom = std::max(std::floor(std::log10(smallest)), top - kMostDecades);
    out.low = std::pow(10.0, bottom);
    out.counts.resize(static_cast<std::size_t>(top - bottom) * static_cast<std::size_t>(per_decade));
  }
  for (const double v : values) {
    if (v <= 0) {
      ++out.below;
      continue;
    }
    const double place = std::floor(std::log10(v / out.low) * per_decade + 1e-9);
    ++out.counts[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(out.counts.size() - 1)))];
  }
  return out;
}

}  // namespace palpate
