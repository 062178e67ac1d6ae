// SPDX-License-Identifier: Apache-2.0
#include "apps/check/ulp.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace ulp_test {

using Limits = std::numeric_limits<float>;
constexpr std::uint32_t kNeverEqual = 0xFFFFFFFFU;

TEST(UlpDistance, OfTheSameBitsIsZero) {
  for (const float x :
       {0.0F, -0.0F, 1.0F, -1e30F, Limits::denorm_min(), Limits::max(), Limits::infinity(), Limits::quiet_NaN()}) {
    EXPECT_EQ(ulpDistance(x, x), 0U) << x;
  }
}

TEST(UlpDistance, OfNeighboursIsOne) {
  for (const float x :
       {1.0F, 2.0F, 0.99999994F, 1e-30F, 1e30F, -1.0F, -1e-30F, Limits::denorm_min(), Limits::min(), -Limits::min()}) {
    const float next = std::nextafter(x, Limits::infinity());
    EXPECT_EQ(ulpDistance(x, next), 1U) << x;
    EXPECT_EQ(ulpDistance(next, x), 1U) << x;
  }
}

TEST(UlpDistance, CountsTheFloatsBetween) {
  EXPECT_EQ(ulpDistance(1, 2), 1U << 23U);  // 2^23 floats in a binade
  EXPECT_EQ(ulpDistance(-1, -2), 1U << 23U);
  EXPECT_EQ(ulpDistance(1, 4), 1U << 24U);
  EXPECT_EQ(ulpDistance(Limits::denorm_min(), Limits::min()), (1U << 23U) - 1);
}

// -0 and +0 have different bits, so between -x and x there is one step more than twice the way to zero.
TEST(UlpDistance, GoesThroughZero) {
  EXPECT_EQ(ulpDistance(-0.0F, 0.0F), 1U);
  EXPECT_EQ(ulpDistance(0.0F, Limits::denorm_min()), 1U);
  EXPECT_EQ(ulpDistance(-0.0F, -Limits::denorm_min()), 1U);
  EXPECT_EQ(ulpDistance(-Limits::denorm_min(), Limits::denorm_min()), 3U);
  EXPECT_EQ(ulpDistance(-1, 1), 2 * 0x3F800000U + 1);
}

TEST(UlpDistance, ReachesInfinity) {
  EXPECT_EQ(ulpDistance(Limits::max(), Limits::infinity()), 1U);
  EXPECT_EQ(ulpDistance(-Limits::infinity(), Limits::infinity()), 2 * 0x7F800000U + 1);
  EXPECT_LT(ulpDistance(-Limits::infinity(), Limits::infinity()), kNeverEqual);
}

TEST(UlpDistance, ToAnotherNanIsTheLargest) {
  for (const float x : {0.0F, 1.0F, -1.0F, Limits::infinity(), -Limits::quiet_NaN()}) {
    EXPECT_EQ(ulpDistance(x, Limits::quiet_NaN()), kNeverEqual);
    EXPECT_EQ(ulpDistance(Limits::quiet_NaN(), x), kNeverEqual);
  }
}

}  // namespace ulp_test
}  // namespace palpate
