// SPDX-License-Identifier: Apache-2.0
#include "base/quantile.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace quantile_test {

TEST(Quantile, IsTheElementThatTheRuleNames) {
  const std::vector<double> ten = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  EXPECT_EQ(quantile(ten, 0.5), 5);  // five of ten are at or below 5
  EXPECT_EQ(quantile(ten, 0.51), 6);
  EXPECT_EQ(quantile(ten, 0.9), 9);
  EXPECT_EQ(quantile(ten, 0.99), 10);
  EXPECT_EQ(quantile(ten, 1), 10);
  EXPECT_EQ(quantile(ten, 0), 1);
}

TEST(Quantile, IsNotMovedByRounding) {
  std::vector<double> hundred(100);
  std::iota(hundred.begin(), hundred.end(), 1.0);
  EXPECT_EQ(quantile(hundred, 0.55), 55);  // 0.55 * 100 is a little above 55 in binary
}

TEST(Quantile, OfNothingIsZero) {
  EXPECT_EQ(quantile({}, 0.5), 0);
}
TEST(Quantile, OfOneIsThatOne) {
  EXPECT_EQ(quantile({7}, 0.5), 7);
}

TEST(Median, IsTheMiddleOrTheMeanOfTwo) {
  EXPECT_EQ(median({7}), 7);
  EXPECT_EQ(median({5, 1, 3}), 3);
  EXPECT_EQ(median({8, 1, 2, 5}), 3.5);
}

TEST(Percentiles, OfAThousandInAnyOrder) {
  std::vector<double> values(1000);
  std::iota(values.rbegin(), values.rend(), 1.0);
  const Percentiles p = percentiles(values);
  EXPECT_EQ(p.count, 1000U);
  EXPECT_EQ(p.p50, 500);
  EXPECT_EQ(p.p90, 900);
  EXPECT_EQ(p.p99, 990);
  EXPECT_EQ(p.p999, 999);
  EXPECT_EQ(p.max, 1000);
}

// Any length, with values that come again and again: as if they were sorted.
TEST(Percentiles, AreThoseOfTheSortedValues) {
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    std::vector<double> values(std::uniform_int_distribution<std::size_t>(1, i < 200 ? 40 : 3000)(random));
    for (double& value : values) value = std::uniform_int_distribution(-20, 20)(random) * 0.1;
    const Percentiles p = percentiles(values);
    std::sort(values.begin(), values.end());
    EXPECT_EQ(p.count, values.size());
    EXPECT_EQ(p.p50, quantile(values, 0.5));
    EXPECT_EQ(p.p90, quantile(values, 0.9));
    EXPECT_EQ(p.p99, quantile(values, 0.99));
    EXPECT_EQ(p.p999, quantile(values, 0.999));
    EXPECT_EQ(p.max, values.back());
  }
  EXPECT_EQ(percentiles({}).max, 0);
}

}  // namespace quantile_test
}  // namespace palpate
