// SPDX-License-Identifier: Apache-2.0
#include "apps/render/slice_range.hpp"

#include <numeric>

namespace palpate {
namespace {

constexpr double kLeftOut = 0.005;  // share of the voxels at either end

// The bin that holds the voxel which the share `q` of all voxels does not exceed.
std::size_t binOf(const Histogram& histogram, double q) {
  const auto all = std::accumulate(histogram.counts.begin(), histogram.counts.end(), std::uint64_t{0});
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    seen += histogram.counts[bin];
    if (static_cast<double>(seen) >= q * static_cast<double>(all)) return bin;
  }
  return histogram.counts.size() - 1;
}

}  // namespace

SliceRange sliceRangeFor(const VolumeStatistics& statistics) {
  const Histogram& histogram = statistics.histogram;
  const std::size_t low = binOf(histogram, kLeftOut), high = binOf(histogram, 1 - kLeftOut);
  if (low == high) return {statistics.minimum, statistics.maximum};
  return {histogram.low + static_cast<double>(low) * histogram.bin_width,
          histogram.low + static_cast<double>(high + 1) * histogram.bin_width};
}

}  // namespace palpate
