// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/cell_walk.hpp"

#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace cell_walk_test {

using testing::DoubleNear;
using testing::ElementsAre;

constexpr double kRounding = 1e-12;  // a few roundings of numbers of size 1

std::vector<double> placesOf(const Vec3& from_L, const Vec3& to_L, const Vec3& last_L) {
  CellWalk walk(from_L, to_L, last_L);
  std::vector<double> places;
  do places.push_back(walk.next());
  while (places.back() < 1 && places.size() < 1000);
  return places;
}

TEST(CellWalk, StopsAtEveryPlaneBetweenCells) {
  EXPECT_THAT(placesOf({0.5, 0.5, 0.5}, {2.5, 0.5, 0.5}, Vec3::Constant(7)),
              ElementsAre(DoubleNear(0.25, kRounding), DoubleNear(0.75, kRounding), 1.0));
  EXPECT_THAT(placesOf({2.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, Vec3::Constant(7)),
              ElementsAre(DoubleNear(0.25, kRounding), DoubleNear(0.75, kRounding), 1.0));
}

TEST(CellWalk, StopsWhereTheLatticeBeginsAndEnds) {
  EXPECT_THAT(placesOf({-1, 0.5, 0.5}, {3, 0.5, 0.5}, Vec3::Constant(1)),
              ElementsAre(DoubleNear(0.25, kRounding), DoubleNear(0.5, kRounding), 1.0));
}

TEST(CellWalk, AWayThatPassesTheLatticeByOrIsNoneHasOnlyItsEnd) {
  EXPECT_THAT(placesOf({-1, 2, 0.5}, {3, 2, 0.5}, Vec3::Constant(1)), ElementsAre(1.0));
  EXPECT_THAT(placesOf({-2, 0, 0}, {0, -2, 0}, Vec3::Constant(1)), ElementsAre(1.0));
  EXPECT_THAT(placesOf({0.3, 0.3, 0.3}, {0.3, 0.3, 0.3}, Vec3::Constant(1)), ElementsAre(1.0));
}

// Between two places the way lies in one cell: its middle and points near both ends have the same low corner.
TEST(CellWalk, BetweenTwoPlacesLiesOneCell) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> anywhere(-2, 11);
  const Vec3 last_L(9, 7, 8);
  int checked = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Vec3 from_L(anywhere(random), anywhere(random), anywhere(random));
    Vec3 to_L(anywhere(random), anywhere(random), anywhere(random));
    if (trial % 3 == 0) from_L = from_L.array().round();  // begins on planes, edges and corners
    if (trial % 5 == 0) to_L[trial % 2] = from_L[trial % 2];
    double before = 0;
    for (const double t : placesOf(from_L, to_L, last_L)) {
      ASSERT_GE(t, before);
      if (t - before > 1e-9) {
        const auto at = [&](double share) { return Vec3(from_L + (before + share * (t - before)) * (to_L - from_L)); };
        const Vec3 middle_L = at(0.5);
        if ((middle_L.array() > 0).all() && (middle_L.array() < last_L.array()).all()) {
          for (const double share : {0.001, 0.999}) {
            for (int axis = 0; axis < 3; ++axis) {
              if (to_L[axis] == from_L[axis]) continue;
              ASSERT_EQ(std::floor(at(share)[axis]), std::floor(middle_L[axis])) << trial;
            }
          }
          ++checked;
        }
      }
      before = t;
    }
  }
  EXPECT_GT(checked, 5000);
}

}  // namespace cell_walk_test
}  // namespace palpate
