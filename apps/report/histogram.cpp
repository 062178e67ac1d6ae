// SPDX-License-Identifier: Apache-2.0
#include "apps/report/histogram.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {
constexpr double kMostDecades = 6;
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
