// SPDX-License-Identifier: Apache-2.0
#include "apps/report/decimate.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace decimate_test {

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

}  // namespace decimate_test
}  // namespace palpate
