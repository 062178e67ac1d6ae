// SPDX-License-Identifier: Apache-2.0
#include "apps/report/plot_data.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace palpate {
namespace plot_data_test {

PlotTable noisyTable(std::size_t rows) {
  PlotTable table;
  table.series.resize(2);
  for (std::size_t i = 0; i < rows; ++i) {
    table.time_s.push_back(static_cast<double>(i) * 1e-3);
    table.series[0].push_back(std::sin(static_cast<double>(i * i)));
    table.series[1].push_back(i == 70'001 ? 1000 : 0);  // a single late tick
  }
  return table;
}

TEST(Decimate, KeepsSmallestAndLargestOfEachBucket) {
  const PlotTable all = noisyTable(100'000), few = decimate(all, 1000);
  ASSERT_EQ(few.time_s.size(), 2000U);
  for (std::size_t bucket = 0; bucket < 1000; ++bucket) {
    const auto begin = all.series[0].begin() + static_cast<std::ptrdiff_t>(bucket) * 100;
    const auto [low, high] = std::minmax_element(begin, begin + 100);
    const auto [a, b] = std::minmax(few.series[0][2 * bucket], few.series[0][2 * bucket + 1]);
    EXPECT_EQ(a, *low);
    EXPECT_EQ(b, *high);
  }
  EXPECT_EQ(std::count(few.series[1].begin(), few.series[1].end(), 1000.0), 1);
}

TEST(Decimate, KeepsTheOrderOfRiseAndFall) {
  PlotTable table{{0, 1, 2, 3, 4, 5, 6, 7}, {{0, 1, 2, 3, 3, 2, 1, 0}}};
  const PlotTable few = decimate(table, 2);
  EXPECT_EQ(few.time_s, (std::vector<double>{0, 3, 4, 7}));
  EXPECT_EQ(few.series[0], (std::vector<double>{0, 3, 3, 0}));
}

TEST(Decimate, DividesRowsThatDoNotDivideEvenly) {
  const PlotTable few = decimate({{0, 1, 2, 3, 4, 5, 6}, {{5, 1, 2, 3, 9, 0, 7}}}, 3);
  EXPECT_EQ(few.time_s, (std::vector<double>{0, 1, 2, 3, 4, 6}));
  EXPECT_EQ(few.series[0], (std::vector<double>{5, 1, 2, 3, 9, 0}));
}

TEST(Decimate, LeavesAShortTableAlone) {
  const PlotTable table = noisyTable(200);
  EXPECT_EQ(decimate(table, 100).series, table.series);
}

TEST(Decimate, ABucketOfGapsIsAGap) {
  PlotTable table{{0, 1, 2, 3, 4, 5}, {{NAN, NAN, NAN, 1, NAN, 3}}};
  const PlotTable few = decimate(table, 2);
  EXPECT_TRUE(std::isnan(few.series[0][0]) && std::isnan(few.series[0][1]));
  EXPECT_EQ(few.series[0][2], 1);
  EXPECT_EQ(few.series[0][3], 3);
}

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

}  // namespace plot_data_test
}  // namespace palpate
