// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/lattice_spline.hpp"

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "servo/contact/shape_operator.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {
namespace lattice_spline_test {

AnalyticVolume slices(bool left_handed, std::function<double(const Vec3&)> density) {
  AnalyticVolume volume;
  volume.lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, 3e-3);
  volume.lattice.R_WL = someRotation();
  if (left_handed) volume.lattice.R_WL.col(0) *= -1;
  volume.size = Vec3i(30, 30, 12);
  volume.density = std::move(density);
  return volume;
}

double densityOf(const SampleWindow& window, const Vec3i& i) {
  return static_cast<double>(sampleAt(window, i).density);
}

// Float samples of up to 1: 1e-7 of them, divided by half a millimetre for a slope.
TEST(LatticeSpline, MeetsALinearFieldAndItsSlope) {
  const Vec3 slope(3, -5, 7);
  for (const bool left_handed : {false, true}) {
    const AnalyticVolume volume = slices(left_handed, [&](const Vec3& p) { return slope.dot(p); });
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    LatticeSpline spline;
    for (const Vec3& way : wander(500)) {
      const Vec3 p = volume.lattice.toWorld(Vec3(15, 15, 6) + 2e3 * way);
      const LatticeSpline::At at = spline.at(held.window, p, densityOf);
      ASSERT_NEAR(at.value, slope.dot(p), 1e-7);
      ASSERT_NEAR((at.gradient_W - slope).norm(), 0, 4e-4);
    }
  }
}

// On random numbers of 0 to 1: the slope is that of the value, both are continuous, and the value stays among the
// numbers. A step s of 2.5e-3 voxel is the mean of its ends' slopes but for s^2 / 8 of what the second derivative jumps
// by, at most 4 along a line: 3e-6.
TEST(LatticeSpline, ItsSlopeIsTheValuesAndBothAreContinuous) {
  std::uint32_t state = 7;
  const AnalyticVolume volume = slices(true, [&](const Vec3&) {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state >> 8) / (1 << 24);
  });
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size);
  LatticeSpline spline;
  const Vec3 step_L = Vec3(0.002, 0.0013, 0.0007);
  Vec3 p_L(2.1, 3.2, 1.3);
  LatticeSpline::At last = spline.at(held.window, volume.lattice.toWorld(p_L), densityOf);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 way_W = volume.lattice.toWorld(p_L + step_L) - volume.lattice.toWorld(p_L);
    p_L += step_L;
    const LatticeSpline::At at = spline.at(held.window, volume.lattice.toWorld(p_L), densityOf);
    ASSERT_NEAR(at.value - last.value, 0.5 * (at.gradient_W + last.gradient_W).dot(way_W), 3e-6);
    ASSERT_LT((at.gradient_W - last.gradient_W).norm(), 0.03 / 0.5e-3);
    ASSERT_GE(at.value, 0);
    ASSERT_LE(at.value, 1);
    last = at;
  }
}

TEST(LatticeSpline, GoesOnLevelBeyondTheWindow) {
  const AnalyticVolume volume = slices(false, [](const Vec3& p) { return 5 * p.norm(); });
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size);
  LatticeSpline spline;
  const auto at = [&](double i) { return spline.at(held.window, volume.lattice.toWorld(Vec3(i, 15, 6)), densityOf); };
  EXPECT_NEAR(at(-3).value, at(0).value, 1e-12);
  EXPECT_NEAR(at(500).value, at(29).value, 1e-12);
  EXPECT_NEAR(at(-3).gradient_W.dot(volume.lattice.R_WL.col(0)), 0, 1e-9);
  EXPECT_GT(at(15).gradient_W.norm(), 1);
}

TEST(LatticeSpline, ReadsTheWindowOfTheTick) {
  AnalyticVolume volume = slices(false, [](const Vec3&) { return 1.0; });
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), volume.size, 1);
  LatticeSpline spline;
  const Vec3 p = volume.lattice.toWorld(Vec3(15, 15, 6));
  ASSERT_EQ(spline.at(held.window, p, densityOf).value, 1);
  volume.density = [](const Vec3&) { return 2.0; };
  volume.hold(held, Vec3i::Zero(), volume.size, 2);
  EXPECT_EQ(spline.at(held.window, p, densityOf).value, 2);
}

// ---- how the surface turns ----

// Gradients of R - |x| at samples R / h voxels out, a voxel aside either way: the secant errs by (h / R)^2 / 3 of 1 /
// R, central differences by (h / R)^2 / 6 and their interpolation by 3 / 8 (h / R)^2 (analytic_surface.hpp): below (h /
// R)^2 = 1 / 200 each way, for a ball and for a hollow one.
TEST(ShapeOperator, IsOneOverTheRadiusOnABall) {
  for (const double out : {1.0, -1.0}) {
    const double R = 20e-3;
    const Vec3 centre = Vec3::Constant(31.3e-3);
    const AnalyticVolume volume = millimetreVolume([=](const Vec3& p) { return out * (R - (p - centre).norm()); });
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    const Vec3 radial = Vec3(0.4, -0.3, 0.8).normalized();
    const Vec3 normal = out * radial;
    const ShapeOperator shape(WindowSampler(held.window), centre + R * radial, normal);
    const Vec3 q = normal.cross(Vec3(0.2, 0.9, -0.1)).normalized();
    EXPECT_NEAR((R * shape.apply(q) - out * q).norm(), 0, 0.02);
    for (const double depth_m : {0.0, 1e-3, 5e-3}) {
      EXPECT_NEAR((shape.slopeAtHip(q, depth_m) - q / (1 - out * depth_m / R)).norm(), 0,
                  0.02 * depth_m / R * 2 + 1e-12);
    }
    // Deeper than the ball is round there is an end.
    EXPECT_LE(shape.slopeAtHip(q, 0.99 * R).norm(), ShapeOperator::kMostGrowth * (1 + 1e-12));
    EXPECT_NEAR(shape.slopeAtHip(normal, 1e-3).norm(), 0, 1e-12);
  }
}

// A saddle, w + 60 a^2 / 2 - 40 b^2 / 2 in metres along a tilted normal and two directions across it: its gradients are
// linear, so samples of them hold them, and S has the eigenvalues 60 and -40. The secants of unit normals over voxels
// of up to 1 mm are too small by (60 h)^2 / 2, below 0.2 % of 60 / m.
class Saddle : public testing::Test {
 protected:
  Saddle() {
    volume_.lattice.spacing_m = Vec3(0.5e-3, 0.7e-3, 1e-3);
    volume_.lattice.R_WL = someRotation();
    volume_.size = Vec3i::Constant(20);
    p_W_ = volume_.lattice.toWorld(Vec3(9.3, 10.2, 8.9));
    volume_.density = [this](const Vec3& at_W) {
      const Vec3 x = at_W - p_W_;
      return -(kNormal.dot(x) + 30 * std::pow(a_.dot(x), 2) - 20 * std::pow(b_.dot(x), 2));
    };
    volume_.hold(held_, Vec3i::Zero(), volume_.size);
  }

  static inline const Vec3 kNormal{0.48, 0.6, 0.64};
  const Vec3 across_ = Vec3(0.8, 0, -0.6);
  const Vec3 a_ = std::cos(0.4) * across_ + std::sin(0.4) * kNormal.cross(across_);
  const Vec3 b_ = kNormal.cross(a_);
  AnalyticVolume volume_;
  HeldWindow held_;
  Vec3 p_W_;
};

TEST_F(Saddle, TurnsDifferentlyInEachDirection) {
  const ShapeOperator shape(WindowSampler(held_.window), p_W_, kNormal);
  for (const double angle : {0.0, 0.3, 0.8, 1.2, 1.57, 2.5}) {
    const double a = std::cos(angle), b = std::sin(angle);
    const Vec3 q = a * a_ + b * b_ + 0.7 * kNormal;  // the part along the normal does not count
    EXPECT_LT((shape.apply(q) - (60 * a * a_ - 40 * b * b_)).norm(), 0.2) << angle;
    for (const double depth_m : {1e-3, 3e-3}) {
      const Vec3 wanted = a / (1 - 60 * depth_m) * a_ + b / (1 + 40 * depth_m) * b_;
      EXPECT_LT((shape.slopeAtHip(q, depth_m) - wanted).norm(), 0.2 * 2 * depth_m) << angle;
    }
    // 15 mm deep 60 / m would multiply by ten, which is more than kMostGrowth; -40 / m still divides by 1.6.
    const Vec3 bounded = ShapeOperator::kMostGrowth * a * a_ + b / 1.6 * b_;
    EXPECT_LT((shape.slopeAtHip(q, 15e-3) - bounded).norm(), 0.02) << angle;
  }
}

// A voxel aside of a place at the window's face there may be no gradient: then the curvature is not known.
TEST_F(Saddle, CountsAsFlatBesideTheWindowsFace) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double at : {0.1, 18.9}) {
      Vec3 p_L(9.3, 10.2, 8.9);
      p_L[axis] = at;
      const ShapeOperator shape(WindowSampler(held_.window), volume_.lattice.toWorld(p_L), kNormal);
      EXPECT_EQ(shape.apply(a_), Vec3::Zero()) << axis << " " << at;
      EXPECT_EQ(shape.apply(b_), Vec3::Zero()) << axis << " " << at;
    }
  }
}

TEST(ShapeOperator, WithoutAWindowItIsFlat) {
  const Vec3 normal = Vec3(1, 2, 3).normalized();
  const Vec3 q = normal.cross(Vec3::UnitX());
  const ShapeOperator shape(WindowSampler(), Vec3::Zero(), normal);
  EXPECT_EQ(shape.apply(q), Vec3::Zero());
  EXPECT_NEAR((shape.slopeAtHip(q, 1e-3) - q).norm(), 0, 1e-15);
}

TEST(VoxelAcross, IsASideAlongAnAxisAndBetweenThemElsewhere) {
  Lattice lattice;
  lattice.spacing_m = Vec3(0.5e-3, 0.5e-3, 3e-3);
  lattice.R_WL = someRotation();
  EXPECT_NEAR(voxelAcross(lattice, lattice.R_WL.col(0)), 0.5e-3, 1e-15);
  EXPECT_NEAR(voxelAcross(lattice, -lattice.R_WL.col(2)), 3e-3, 1e-15);
  const Vec3 between = (lattice.R_WL.col(0) + lattice.R_WL.col(2)).normalized();
  EXPECT_NEAR(voxelAcross(lattice, between), std::sqrt((0.25e-6 + 9e-6) / 2), 1e-15);
}

}  // namespace lattice_spline_test
}  // namespace palpate
