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
