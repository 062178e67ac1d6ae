// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/lateness.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace lateness_test {

TEST(LatenessCounts, QuantilesAreClassesThatWereSeen) {
  LatenessCounts counts;
  for (int us = 1; us <= 100; ++us) counts.add(us);
  EXPECT_EQ(counts.total(), 100);
  EXPECT_EQ(counts.quantile_us(0.5), 50);
  EXPECT_EQ(counts.quantile_us(0.99), 99);
  EXPECT_EQ(counts.quantile_us(1), 100);
  EXPECT_EQ(counts.quantile_us(0), 1);
}

TEST(LatenessCounts, AMissIsLaterThanAPeriod) {
  LatenessCounts counts;
  counts.add(999, 3);
  counts.add(1000, 2);
  counts.add(1001, 1);
  EXPECT_EQ(counts.misses(1000), 3);
  EXPECT_EQ(counts.misses(4000), 6);
  EXPECT_EQ(counts.misses(100), 0);
}

TEST(LatenessCounts, TooLateAndTooEarlyGoIntoTheLastClasses) {
  LatenessCounts counts;
  counts.add(-5);
  counts.add(10 * LatenessCounts::kOverflow_us);
  EXPECT_EQ(counts.quantile_us(0.5), 0);
  EXPECT_EQ(counts.quantile_us(1), LatenessCounts::kOverflow_us);
  EXPECT_EQ(counts.atLeast(1), 1);
}

TEST(LatenessCounts, AddUp) {
  LatenessCounts a, b;
  a.add(5, 2);
  b.add(7, 3);
  a.add(b);
  EXPECT_EQ(a.total(), 5);
  EXPECT_EQ(a.atLeast(6), 3);
}

TEST(LatenessCounts, OfNothingAreZero) {
  EXPECT_EQ(LatenessCounts{}.quantile_us(0.99), 0);
  EXPECT_EQ(LatenessCounts{}.misses(1000), 0);
}

}  // namespace lateness_test
}  // namespace palpate
