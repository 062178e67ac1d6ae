// SPDX-License-Identifier: Apache-2.0
// What every comparison of floats with a formula rests on: the compiler rounds where the source says so.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "base/vec.hpp"

namespace palpate {
namespace rounding_test {

// 0.1 lies between two floats; the nearer one is 0.1 + 1.49e-9.
constexpr double kTenth = 0.1, kNearestFloat = 0.100000001490116119384765625;

// Not inlined, so that the compiler does not know what is in it.
[[gnu::noinline]] void roundPair(double* pair) {
  for (int i = 0; i < 2; ++i) pair[i] = static_cast<double>(static_cast<float>(pair[i]));
}
[[gnu::noinline]] void roundPoints(std::vector<Vec3>& points) {
  for (Vec3& point : points) point = point.cast<float>().cast<double>();
}

// GCC 12 makes one vector of two neighbours and leaves the conversions out.
TEST(Rounding, NeighboursThatBecomeFloatsAndDoublesAgainAreRounded) {
  std::array<double, 2> pair = {kTenth, -kTenth};
  roundPair(pair.data());
  EXPECT_EQ(pair[0], kNearestFloat);
  EXPECT_EQ(pair[1], -kNearestFloat);
  std::vector<Vec3> points(3, Vec3(kTenth, -kTenth, kTenth));
  roundPoints(points);
  for (const Vec3& point : points) EXPECT_EQ(point, Vec3(kNearestFloat, -kNearestFloat, kNearestFloat));
}

}  // namespace rounding_test
}  // namespace palpate
