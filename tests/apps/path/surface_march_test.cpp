// SPDX-License-Identifier: Apache-2.0
#include "apps/path/surface_march.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analytic_field.hpp"

namespace palpate {
namespace surface_march_test {

constexpr double kVoxel_m = 0.5e-3;

// On a circle of radius R a chord h spans the arc 2 R asin(h / 2R): after the whole way the place is known exactly.
TEST(SurfaceMarch, GoesAroundASphereOnAGreatCircle) {
  const double radius_m = 10e-3;
  const AnalyticField sphere([=](const Vec3& p) { return sphereDistance(p, radius_m); }, 16e-3, kVoxel_m);
  const auto curve = marchSurface(sphere, {Vec3(0, 0, radius_m), Vec3::UnitZ()}, Vec3(1, 0, 0.3), 25e-3);
  const auto steps = static_cast<double>(curve.points.size() - 1);
  EXPECT_NEAR(curve.length(), 25e-3, 1e-12);
  EXPECT_LE(curve.step_m, kVoxel_m / 4);
  const double angle = steps * 2 * std::asin(curve.step_m / (2 * radius_m));
  const Vec3 expected = radius_m * Vec3(std::sin(angle), 0, std::cos(angle));
  EXPECT_LT((curve.points.back().p_W - expected).norm(), 1e-7);
}

TEST(SurfaceMarch, FollowsSharpEdgesIntoAHoleAndOut) {
  const AnalyticField slab(slabWithHole, 30e-3, kVoxel_m);
  const auto curve =
      marchSurface(slab, {Vec3(-10e-3, 0, 10e-3), Vec3::UnitZ()}, Vec3::UnitX(), 5e-3 + 8e-3 + 10e-3 + 8e-3 + 3e-3);
  bool was_on_floor = false;
  for (const SurfaceHit& point : curve.points) {
    EXPECT_NEAR(slabWithHole(point.p_W), 0, 1e-9);
    was_on_floor |= point.p_W.head<2>().norm() < 1e-3 && std::abs(point.p_W.z() - 2e-3) < 1e-9;
  }
  EXPECT_TRUE(was_on_floor);
  // Each of the four corners is cut by one chord: at most (sqrt 2 - 1) step longer or shorter than the way along the
  // walls.
  EXPECT_NEAR(curve.points.back().p_W.x(), 8e-3, 4 * 0.5 * kVoxel_m / 4 * 2);
  EXPECT_NEAR(curve.points.back().p_W.z(), 10e-3, 1e-9);
}

// The hole is 10 mm wide from x = -5 mm to 5 mm: straight on means level across it, and on the surface again beyond. A
// corner may be cut, or left late, by a step on either side of the hole.
TEST(SurfaceMarch, GoesStraightOnOverAHoleWhenAsked) {
  const AnalyticField slab(slabWithHole, 30e-3, kVoxel_m);
  const auto curve =
      marchSurface(slab, {Vec3(-10e-3, 0, 10e-3), Vec3::UnitZ()}, Vec3::UnitX(), 20e-3, OverEdges::kStraight);
  for (const SurfaceHit& point : curve.points) EXPECT_NEAR(point.p_W.z(), 10e-3, 2 * curve.step_m);
  EXPECT_NEAR(curve.free_m, 10e-3, 4 * curve.step_m);
  EXPECT_NEAR(curve.points.back().p_W.x(), 10e-3, 4 * curve.step_m);
  EXPECT_NEAR(slabWithHole(curve.points.back().p_W), 0, 1e-9);
}

TEST(SurfaceMarch, EndsAtTheVolumesBorder) {
  const AnalyticField plane([](const Vec3& p) { return -p.z(); }, 10e-3, kVoxel_m);
  for (const OverEdges over_edges : {OverEdges::kFollow, OverEdges::kStraight}) {
    const auto curve = marchSurface(plane, {Vec3::Zero(), Vec3::UnitZ()}, Vec3::UnitX(), 25e-3, over_edges);
    EXPECT_LE(curve.length(), 10e-3);
    EXPECT_GE(curve.length(), 10e-3 - kVoxel_m / 2);  // a step's circle must lie inside, so the last one may be missing
  }
}

// The ground as a height over x; the way begins at x = 0 and goes to the right.
template <typename Ground>
SurfaceCurve straightOver(Ground ground, double length_m) {
  const AnalyticField field([=](const Vec3& p) { return ground(p.x()) - p.z(); }, 16e-3, kVoxel_m);
  return marchSurface(field, {Vec3::Zero(), Vec3::UnitZ()}, Vec3::UnitX(), length_m, OverEdges::kStraight);
}
double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

// A slope that begins after 5 mm: it is gone down up to 40 degrees.
TEST(SurfaceMarch, StraightOnGoesDownSlopesUpToFortyDegrees) {
  const auto slope = [](double degrees) {
    return [=](double x) { return -std::tan(radians(degrees)) * std::max(x - 5e-3, 0.0); };
  };
  EXPECT_EQ(straightOver(slope(39.5), 10e-3).free_m, 0);
  EXPECT_GT(straightOver(slope(40.5), 10e-3).free_m, 4.5e-3);
}

// A ramp of 30 degrees from 2 mm on, and a cliff at 5.95 mm. After a ramp down each step falls nine tenths as steeply
// as the last: sum of 0.125 mm * sin(30 degrees * 0.9^k) = 0.575 mm in all, less what the edge is lower than the last
// point on it, a part of a step. After a ramp up the way is level at once.
TEST(SurfaceMarch, StraightOnLevelsOffBeyondAnEdge) {
  for (const double slope : {-std::tan(radians(30)), std::tan(radians(30))}) {
    const auto ground = [=](double x) { return x > 5.95e-3 ? -1 : slope * std::max(x - 2e-3, 0.0); };
    const SurfaceCurve curve = straightOver(ground, 12e-3);
    const double fallen_m = slope * 3.95e-3 - curve.points.back().p_W.z();
    EXPECT_NEAR(fallen_m, slope < 0 ? 0.575e-3 : 0, 0.0625e-3);
    EXPECT_NEAR(curve.free_m, 12e-3 - 2e-3 - 3.95e-3 / std::cos(radians(30)), curve.step_m);
    EXPECT_EQ(curve.points.back().normal_W, Vec3::UnitZ());
  }
}

TEST(SurfaceMarch, NoLengthIsOnePoint) {
  const AnalyticField plane([](const Vec3& p) { return -p.z(); }, 10e-3, kVoxel_m);
  EXPECT_EQ(marchSurface(plane, {Vec3::Zero(), Vec3::UnitZ()}, Vec3::UnitX(), 0).points.size(), 1U);
}

}  // namespace surface_march_test
}  // namespace palpate
