// SPDX-License-Identifier: Apache-2.0
#include "apps/report/histogram.hpp"

#include <numeric>

#include <gtest/gtest.h>

namespace palpate {
namespace histogram_test {

TEST(LogHistogram, PutsValuesIntoClassesByDecade) {
  const LogHistogram h = logHistogram({0, -1, 1, 2, 9.99, 10, 50, 999}, 1);
  EXPECT_EQ(h.low, 1);
  EXPECT_DOUBLE_EQ(h.ratio, 10);
  EXPECT_EQ(h.counts, (std::vector<std::size_t>{3, 2, 1}));
  EXPECT_EQ(h.below, 2U);
  EXPECT_DOUBLE_EQ(h.edge(2), 100);
}

// Two classes a decade, from the decade of the smallest: edges are 0.1, 0.316, 1, 3.16, 10, 31.6 and 100.
TEST(LogHistogram, DividesDecades) {
  const LogHistogram h = logHistogram({31, 1, 3, 4, 0.5, 32, 10}, 2);
  EXPECT_DOUBLE_EQ(h.low, 0.1);
  EXPECT_DOUBLE_EQ(h.edge(2), 1);
  EXPECT_EQ(h.counts, (std::vector<std::size_t>{0, 1, 2, 1, 2, 1}));
  EXPECT_EQ(h.below, 0U);
}

TEST(LogHistogram, LosesNoValueWhateverTheRange) {
  const LogHistogram h = logHistogram({1e-9, 1, 1e9}, 10);
  EXPECT_EQ(std::accumulate(h.counts.begin(), h.counts.end(), std::size_t{0}), 3U);
  EXPECT_LE(h.counts.size(), 60U);
  EXPECT_EQ(h.counts.front(), 2U);
}

TEST(LogHistogram, OfZerosHasNoClass) {
  const LogHistogram h = logHistogram({0, 0}, 10);
  EXPECT_TRUE(h.counts.empty());
  EXPECT_EQ(h.below, 2U);
}

}  // namespace histogram_test
}  // namespace palpate
