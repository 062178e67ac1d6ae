// SPDX-License-Identifier: Apache-2.0
#include "apps/onlook/seen_volume.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace seen_volume_test {

double reach(const SeenExtent& extent, const Vec3& along) {
  double most = -1e300;
  for (const Vec3& point_W : extent.points_W) most = std::max(most, point_W.dot(along));
  return most;
}

// Clouds, flat discs, needles and boxes of any size and place: as thin as an object's extent may be.
SeenExtent anyExtent(Seeded& random, int points) {
  const Mat3 axes = random.axes(false);
  const Vec3 half(random.logBetween(1e-4, 1), random.logBetween(1e-4, 1), random.logBetween(1e-4, 1));
  SeenExtent extent{.middle_W = random.inCube(1), .points_W = {}};
  const int kind = random.pick(3);
  for (int i = 0; i < points; ++i) {
    Vec3 p = kind == 0 ? random.inCube(1) : random.direction();
    if (kind == 2) p = p.array().sign();  // corners, each many times
    extent.points_W.push_back(extent.middle_W + axes * half.cwiseProduct(p));
  }
  return extent;
}

// Each is one of those that were there; whatever the direction, less than a hundredth of the radius is lost.
TEST(SeenExtent, ReachesAsFarWithFewerPoints) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    Seeded random(seed);
    const SeenExtent all = anyExtent(random, 2000);
    const SeenExtent fewer = withFewerPoints(all, 1000);
    EXPECT_EQ(fewer.middle_W, all.middle_W);
    EXPECT_LE(fewer.points_W.size(), 1000U);
    for (const Vec3& point_W : fewer.points_W) ASSERT_NE(std::ranges::find(all.points_W, point_W), all.points_W.end());
    double radius_m = 0;
    for (const Vec3& point_W : all.points_W) radius_m = std::max(radius_m, (point_W - all.middle_W).norm());
    for (int i = 0; i < 200; ++i) {
      const Vec3 along = random.direction();
      EXPECT_LT(reach(all, along) - reach(fewer, along), 0.01 * radius_m) << seed;
    }
  }
}

TEST(SeenExtent, KeepsFewAsTheyAre) {
  Seeded random(1);
  const SeenExtent few = anyExtent(random, 1000);
  EXPECT_EQ(withFewerPoints(few, 1000).points_W, few.points_W);
}

}  // namespace seen_volume_test
}  // namespace palpate
