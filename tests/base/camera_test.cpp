// SPDX-License-Identifier: Apache-2.0
#include "base/camera.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace palpate {
namespace camera_test {

// At 1 m above the origin, looking down -z with +y up: fov 90 degrees over 100 pixels, so 1 m below lies 1 m per 50
// pixels.
Camera downwards() {
  return lookAt(Vec3::Zero(), Vec3::UnitZ(), 1, Vec3::UnitY(), 200, 100, std::numbers::pi / 2);
}

TEST(Camera, ProjectsPointsCalculatedByHand) {
  const Camera camera = downwards();
  const auto middle = camera.project(Vec3::Zero());
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->x, 100, 1e-9);
  EXPECT_NEAR(middle->y, 50, 1e-9);
  EXPECT_NEAR(middle->distance_m, 1, 1e-12);

  const auto corner = camera.project(Vec3(2, 1, 0));
  EXPECT_NEAR(corner->x, 200, 1e-9);  // right edge
  EXPECT_NEAR(corner->y, 0, 1e-9);    // upper edge
  EXPECT_NEAR(corner->distance_m, std::sqrt(6.0), 1e-12);

  const auto deeper = camera.project(Vec3(1, -1, -1));  // twice as far: half as large
  EXPECT_NEAR(deeper->x, 125, 1e-9);
  EXPECT_NEAR(deeper->y, 75, 1e-9);
}

// With an angle of 2 atan(3/4) the picture shows 1.5 m for each metre of depth, over 100 pixels.
TEST(Camera, APixelIsTheHeightOfTheViewOverThePixels) {
  Camera camera = downwards();
  camera.vertical_fov_rad = 2 * std::atan(0.75);
  EXPECT_NEAR(camera.pixelSize(1), 0.015, 1e-15);
  EXPECT_NEAR(camera.pixelSize(2), 0.03, 1e-15);
}

TEST(Camera, SeesNothingBehindItself) {
  EXPECT_FALSE(downwards().project(Vec3(0, 0, 1.5)));
  EXPECT_FALSE(downwards().project(Vec3(0.5, 0, 1)));  // beside itself
}

TEST(Camera, RayThroughAPixelIsItsProjectionBackwards) {
  const Camera camera = lookAt(Vec3(1, 2, 3), Vec3(1, 1, 1).normalized(), 5, Vec3::UnitZ(), 640, 480, 0.6);
  const auto p = camera.project(camera.position_W + 4 * camera.rayThrough(123.5, 77.5));
  ASSERT_TRUE(p);
  EXPECT_NEAR(p->x, 123.5, 1e-9);
  EXPECT_NEAR(p->y, 77.5, 1e-9);
  EXPECT_NEAR(p->distance_m, 4, 1e-12);
}

TEST(Camera, LookAtGivesARightHandedFrame) {
  const Camera camera = lookAt(Vec3::Zero(), Vec3(1, -2, 0.5).normalized(), 1, Vec3::UnitZ(), 10, 10, 0.5);
  EXPECT_LT((camera.forward_W.cross(camera.up_W) - camera.right_W).norm(), 1e-12);
  EXPECT_NEAR(camera.up_W.norm(), 1, 1e-12);
  EXPECT_GT(camera.up_W.z(), 0);
}

}  // namespace camera_test
}  // namespace palpate
