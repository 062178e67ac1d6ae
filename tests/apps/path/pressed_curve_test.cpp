// SPDX-License-Identifier: Apache-2.0
// Curves whose smoothed form is known: a Gaussian of deviation s shortens the radius vector of a circle by
// exp(-s^2 / 2R^2), lifts a parabola by the variance, and leaves a straight line alone.
#include "apps/path/pressed_curve.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analytic_field.hpp"

namespace palpate {
namespace pressed_curve_test {

constexpr double kVoxel_m = 1e-3, kStep_m = 0.25e-3, kRadius_m = 4e-3;

// 161 points on a circle of 4 mm, the middle one on top.
SurfaceCurve circle() {
  SurfaceCurve curve;
  curve.step_m = kStep_m;
  for (int i = -80; i <= 80; ++i) {
    const double angle = i * kStep_m / kRadius_m;
    const Vec3 out(std::sin(angle), 0, std::cos(angle));
    curve.points.push_back({kRadius_m * out, out});
  }
  return curve;
}

// The points by 0.75 mm, the normals by the depth or 1.5 mm. Kernels end at four standard deviations, which lessens
// their variance by 0.11 %: of what they take off, at most 0.24 mm, less than 1 um.
TEST(PressedCurve, FollowsACircleAtTheSmoothedDepth) {
  const auto share = [](double sigma_m) { return std::exp(-0.5 * sigma_m * sigma_m / (kRadius_m * kRadius_m)); };
  const PressedCurve deep(circle(), 2e-3, kVoxel_m), shallow(circle(), 1e-3, kVoxel_m);
  EXPECT_LT((deep.at(0.5) - Vec3(0, 0, kRadius_m * share(0.75e-3) - 2e-3 * share(2e-3))).norm(), 1e-6);
  EXPECT_LT((shallow.at(0.5) - Vec3(0, 0, kRadius_m * share(0.75e-3) - 1e-3 * share(1.5e-3))).norm(), 1e-6);
}

TEST(PressedCurve, BeginsAndEndsAtTheDepthUnderTheEnds) {
  const SurfaceCurve surface = circle();
  const PressedCurve curve(surface, 2e-3, kVoxel_m);
  const SurfaceHit &first = surface.points.front(), &last = surface.points.back();
  EXPECT_LT((curve.at(0) - (first.p_W - 2e-3 * first.normal_W)).norm(), 1e-12);
  EXPECT_LT((curve.at(1) - (last.p_W - 2e-3 * last.normal_W)).norm(), 1e-12);
  EXPECT_EQ(curve.at(-0.5), curve.at(0));
  EXPECT_EQ(curve.at(1.5), curve.at(1));
}

// A Catmull-Rom spline keeps a parabola between its points too.
TEST(PressedCurve, JoinsItsPointsSmoothly) {
  SurfaceCurve surface;
  surface.step_m = kStep_m;
  const auto height = [](double x) { return 1e3 * x * x; };  // [m]
  for (int i = -20; i <= 20; ++i) {
    surface.points.push_back({Vec3(i * kStep_m, 2e-3, height(i * kStep_m)), Vec3::UnitZ()});
  }
  const PressedCurve curve(surface, 0, kVoxel_m);
  const double lift_m = curve.at(0.5).z();
  EXPECT_NEAR(lift_m, 1e3 * 0.75e-3 * 0.75e-3, 1e-6);
  for (const double share : {0.36, 0.4125, 0.48, 0.53, 0.6175}) {
    const double x = (share - 0.5) * 40 * kStep_m;
    EXPECT_LT((curve.at(share) - Vec3(x, 2e-3, height(x) + lift_m)).norm(), 1e-12) << share;
  }
}

TEST(PressedCurve, OfOnePointIsThatPointPressedIn) {
  SurfaceCurve surface;
  surface.points = {SurfaceHit{Vec3(1e-3, 2e-3, 3e-3), Vec3::UnitX()}};
  const PressedCurve curve(surface, 0.5e-3, kVoxel_m);
  EXPECT_EQ(curve.at(0.3), Vec3(0.5e-3, 2e-3, 3e-3));
}

// Points at 0, 1, 2, 3 and 4 mm: object up to 2.5 mm, exactly the isovalue beyond, and the last is not in the volume.
TEST(PressedCurve, CountsThePointsThatAreOutside) {
  const AnalyticField mask([](const Vec3& p) { return p.x() < 2.5e-3 ? 1.0 : 0.0; }, 3.6e-3, 0.9e-3);
  SurfaceCurve surface;
  surface.step_m = 1e-3;
  for (int i = 0; i < 5; ++i) surface.points.push_back({Vec3(i * 1e-3, 0, 0), Vec3::UnitZ()});
  EXPECT_DOUBLE_EQ(PressedCurve(surface, 0, kVoxel_m).shareOutside(mask), 0.2);
}

}  // namespace pressed_curve_test
}  // namespace palpate
