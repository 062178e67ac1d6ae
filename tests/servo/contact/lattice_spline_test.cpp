// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/lattice_spline.hpp"

#include <array>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"
#include "servo/contact/shape_operator.hpp"
#include "support/analytic_volume.hpp"
#include "support/seeded.hpp"

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

// The bends that are stated are never exceeded, and nearly reached: second differences of the field, which is of second
// degree between two samples' borders, over 1e-3 voxel. Numbers of a noise of two values, and on either side of a
// plane.
TEST(LatticeSpline, BendsByNoMoreThanStated) {
  Seeded random(3);
  double noise = 0, border = 0;
  for (int i = 0; i < 40'000; ++i) {
    const bool is_border = i % 2 == 0;
    const Vec3 across = random.direction();
    const double off = random.between(-1.5, 1.5);
    const Vec3 u(random.between(-0.498, 0.498), random.between(-0.498, 0.498), random.between(-0.498, 0.498));
    const Vec3 way = random.pick(2) == 0 ? across : random.direction();
    std::array<double, 27> numbers;
    std::size_t n = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          numbers[n++] = is_border ? (across.dot(Vec3(x, y, z)) > off ? 1 : 0) : random.pick(2);
    AnalyticVolume volume;
    volume.size = Vec3i::Constant(3);
    volume.density = [&](const Vec3& p) {
      const Vec3i at = p.array().round().cast<int>();
      return numbers[static_cast<std::size_t>(at.x() + 3 * (at.y() + 3 * at.z()))];
    };
    volume.lattice.spacing_m = Vec3::Ones();
    HeldWindow held;
    volume.hold(held, Vec3i::Zero(), volume.size);
    LatticeSpline spline;
    const double q = 1e-3;
    const auto at = [&](double share) {
      return spline.at(held.window, Vec3::Ones() + u + share * q * way, densityOf).value;
    };
    const double bend = (at(1) - 2 * at(0) + at(-1)) / (q * q);
    (is_border ? border : noise) = std::max(is_border ? border : noise, std::abs(bend));
  }
  EXPECT_LE(noise, 0.5 * LatticeSpline::kMostBend);
  EXPECT_GT(noise, 0.6 * 0.5 * LatticeSpline::kMostBend);
  EXPECT_LE(border, LatticeSpline::kBorderBend + 1e-3);
  EXPECT_GT(border, 0.85 * LatticeSpline::kBorderBend);
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
