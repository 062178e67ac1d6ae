// SPDX-License-Identifier: Apache-2.0
// Histograms of 1000 voxels, counted by hand.
#include "apps/render/slice_range.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace slice_range_test {

VolumeStatistics withCounts(std::vector<std::uint64_t> counts) {
  VolumeStatistics statistics;
  statistics.minimum = -10;
  statistics.maximum = -10 + 2.0 * static_cast<double>(counts.size());
  statistics.histogram = {-10, 2, std::move(counts)};
  return statistics;
}

// The fifth voxel lies in bin 1 (from -8), the 995th in bin 3 (up to -2).
TEST(SliceRange, LeavesAHalfPercentOutAtEitherEnd) {
  const SliceRange range = sliceRangeFor(withCounts({4, 2, 988, 3, 3}));
  EXPECT_EQ(range.black, -8);
  EXPECT_EQ(range.white, -2);
}

TEST(SliceRange, IsTheWholeRangeWhereOneBinHoldsNearlyAll) {
  const SliceRange range = sliceRangeFor(withCounts({2, 996, 2}));
  EXPECT_EQ(range.black, -10);
  EXPECT_EQ(range.white, -4);
}

}  // namespace slice_range_test
}  // namespace palpate
