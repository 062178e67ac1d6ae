// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/orbit_view.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace orbit_view_test {

constexpr double kPi = std::numbers::pi;

// A box of 2 x 4 x 6 cm around a place.
SeenExtent box(const Vec3& middle_W = Vec3(0.1, -0.2, 0.3)) {
  SeenExtent extent{middle_W, {}};
  for (int corner = 0; corner < 8; ++corner) {
    extent.points_W.push_back(middle_W + Vec3((corner & 1) != 0 ? 0.01 : -0.01, (corner & 2) != 0 ? 0.02 : -0.02,
                                              (corner & 4) != 0 ? 0.03 : -0.03));
  }
  return extent;
}

void expectAllSeen(const OrbitView& view, const SeenExtent& extent) {
  const Camera camera = view.camera();
  double filled = 0;
  for (const Vec3& point_W : extent.points_W) {
    const auto seen = camera.project(point_W);
    ASSERT_TRUE(seen.has_value());
    filled = std::max({filled, std::abs(2 * seen->x / camera.width - 1), std::abs(2 * seen->y / camera.height - 1)});
  }
  EXPECT_LE(filled, 1.0);
  EXPECT_GE(filled, 0.9);
}

TEST(OrbitView, BeginsWithAllOfItFromTheFront) {
  const OrbitView view(box(), 640, 480);
  EXPECT_NEAR((view.camera().forward_W - Vec3::UnitY()).norm(), 0, 1e-12);
  EXPECT_NEAR((view.camera().up_W - Vec3::UnitZ()).norm(), 0, 1e-12);
  expectAllSeen(view, box());
}

TEST(OrbitView, FitsFromEverySideAndInEveryShapeOfWindow) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  OrbitView view(box(), 640, 480);
  for (int trial = 0; trial < 100; ++trial) {
    view.resize(10 + static_cast<int>(random() % 2000), 10 + static_cast<int>(random() % 2000));
    view.turnTo({kPi * unit(random), kPi / 2 * unit(random)});
    view.pan(500 * unit(random), 500 * unit(random));
    view.zoom(20 * unit(random), Vec3(unit(random), unit(random), unit(random)));
    view.fit();
    expectAllSeen(view, box());
  }
  view.setExtent(box(Vec3::Zero()));
  view.fit();
  expectAllSeen(view, box(Vec3::Zero()));
}

// Dragging to the right brings the object's left side to the front; downwards, its top. Straight above is the end.
TEST(OrbitView, TurnsWithThePointer) {
  OrbitView view(box(), 640, 480);
  const Vec3 right_before = view.camera().right_W;
  view.orbit(240, 0);  // half the height: a quarter of a turn
  EXPECT_NEAR((view.camera().forward_W - right_before).norm(), 0, 1e-12);
  view.orbit(0, 120);
  EXPECT_NEAR(view.angles().elevation_rad, kPi / 4, 1e-12);
  EXPECT_LT(view.camera().forward_W.z(), 0);  // from above
  view.orbit(0, 1000);
  EXPECT_EQ(view.angles().elevation_rad, kPi / 2);
  view.orbit(0, -5000);
  EXPECT_EQ(view.angles().elevation_rad, -kPi / 2);
  EXPECT_TRUE(view.camera().right_W.allFinite());
  for (int i = 0; i < 1000; ++i) view.orbit(333, 0);
  EXPECT_LE(std::abs(view.angles().azimuth_rad), kPi);
}

// What was under the pointer is under it after it has moved.
TEST(OrbitView, PansWithThePointer) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    OrbitView view(box(), 640, 480);
    view.orbit(300 * unit(random), 100 * unit(random));
    const Camera camera = view.camera();
    const double depth_m = trial % 2 == 0 ? view.distance_m() : view.distance_m() * (1.5 + unit(random));
    const double x = 320 + 300 * unit(random), y = 240 + 200 * unit(random);
    const Vec3 ray_W = camera.rayThrough(x, y);
    const Vec3 p_W = camera.position_W + depth_m / ray_W.dot(camera.forward_W) * ray_W;
    const double dx = 100 * unit(random), dy = 100 * unit(random);
    view.pan(dx, dy, trial % 2 == 0 ? 0 : depth_m);
    const auto seen = view.camera().project(p_W);
    ASSERT_TRUE(seen.has_value());
    EXPECT_NEAR(seen->x, x + dx, 1e-6);
    EXPECT_NEAR(seen->y, y + dy, 1e-6);
  }
}

TEST(OrbitView, ZoomsTowardsAPointThatStays) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int trial = 0; trial < 100; ++trial) {
    OrbitView view(box(), 640, 480);
    view.orbit(300 * unit(random), 100 * unit(random));
    const Vec3 p_W = box().middle_W + 0.02 * Vec3(unit(random), unit(random), unit(random));
    const auto before = view.camera().project(p_W);
    const double distance_m = view.distance_m(), steps = 5 * unit(random);
    view.zoom(steps, p_W);
    EXPECT_NEAR(view.distance_m(), distance_m * std::pow(0.9, steps), 1e-9);
    const auto after = view.camera().project(p_W);
    ASSERT_TRUE(before && after);
    EXPECT_NEAR(after->x, before->x, 1e-6);
    EXPECT_NEAR(after->y, before->y, 1e-6);
  }
}

TEST(OrbitView, ZoomsWithinLimitsOfTheObjectsSize) {
  OrbitView view(box(), 640, 480);
  const double radius_m = Vec3(0.01, 0.02, 0.03).norm();
  for (int i = 0; i < 50; ++i) view.zoom(1e300, view.target_W());
  EXPECT_NEAR(view.distance_m(), OrbitView::kNearest * radius_m, 1e-12);
  for (int i = 0; i < 50; ++i) view.zoom(-50, view.target_W());
  EXPECT_NEAR(view.distance_m(), OrbitView::kFarthest * radius_m, 1e-9);
  EXPECT_TRUE(view.camera().position_W.allFinite());
}

TEST(OrbitView, TakesAWindowWithoutPixels) {
  OrbitView view(box(), 0, -3);
  EXPECT_EQ(view.camera().width, 1);
  EXPECT_EQ(view.camera().height, 1);
  view.resize(0, 0);
  view.orbit(1, 1);
  EXPECT_TRUE(view.camera().position_W.allFinite());
}

}  // namespace orbit_view_test
}  // namespace palpate
