// SPDX-License-Identifier: Apache-2.0
#include "apps/devices/hand_way.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace hand_way_test {

TEST(HandWay, IsNamedByTheAxisInWhichItWentFurthest) {
  const char* const words[3][2] = {{"left", "right"}, {"down", "up"}, {"away from you", "towards you"}};
  Seeded random(1);
  for (int i = 0; i < 200; ++i) {
    const int axis = random.pick(3);
    const bool positive = random.pick(2) == 0;
    Vec3 way_D = random.inCube(0.02);
    way_D[axis] = (positive ? 1 : -1) * random.between(0.021, 0.2);
    const HandWay way = handWay(way_D);
    EXPECT_EQ(way.axis, axis);
    EXPECT_EQ(way.positive, positive);
    EXPECT_DOUBLE_EQ(way.length_m, way_D.norm());
    EXPECT_EQ(wordOf(way), std::string(words[axis][positive ? 1 : 0]));
  }
}

// By some 6 cm: 36 to 96 mm, along this axis and no other, to its positive side (docs/devices.md).
TEST(HandWay, IsWhatAUserWasAskedFor) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& [length_m, is_asked] :
         {std::pair(0.0, false), std::pair(0.035, false), std::pair(0.0361, true), std::pair(kAsked_m, true),
          std::pair(0.0959, true), std::pair(0.097, false), std::pair(-kAsked_m, false)}) {
      const HandWay way = handWay(length_m * Vec3::Unit(axis));
      EXPECT_EQ(isAsked(way, axis), is_asked) << length_m;
      EXPECT_FALSE(isAsked(way, (axis + 1) % 3)) << length_m;
    }
  }
}

// Rests for half a second, goes to a place within 0.4 s, trembles there. Its way is told once it has rested there for
// 0.3 s, and not before; the last 4 mm of its way, which take 64 ms at most, may count as rest.
TEST(HandMove, IsSeenOnceTheHandRestsAgain) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    const Vec3 from_D = random.inCube(0.05), way_D = random.between(0.025, 0.1) * random.direction();
    HandMove move;
    for (int ms = 0; ms < 2000; ++ms) {
      const double share = std::min(1.0, std::max(0.0, (ms - 500) / 400.0));
      const std::optional<Vec3> seen_D =
          move.look(from_D + share * way_D + 0.2 * HandMove::kRest_m * random.direction(), 1e-3 * ms);
      if (ms < 900 + 300 - 64) {
        ASSERT_FALSE(seen_D) << ms;
      } else if (ms > 900 + 400) {
        ASSERT_TRUE(seen_D) << ms;
        ASSERT_LE((*seen_D - way_D).norm(), HandMove::kRest_m);
      }
    }
  }
}

TEST(HandMove, IsNoneOfLessThanTwoCentimetres) {
  HandMove move;
  for (int ms = 0; ms < 2000; ++ms) {
    const double along_m = ms < 600 ? 0 : 0.019;
    ASSERT_FALSE(move.look(Vec3(along_m, 0, 0), 1e-3 * ms)) << ms;
  }
}

}  // namespace hand_way_test
}  // namespace palpate
