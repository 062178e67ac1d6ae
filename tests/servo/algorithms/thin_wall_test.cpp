// SPDX-License-Identifier: Apache-2.0
// Walls of one voxel under fast strokes.
//
// A wall of thickness 1 voxel, sampled as a tent of its distance, keeps a peak above the isovalue wherever a sample
// lies nearer than half a voxel to its middle, and then is at least half a voxel thick. A thinner one has holes: where
// its middle passes halfway between samples none is above the isovalue, and nothing can be felt because nothing is
// there.
#include <random>

#include <gtest/gtest.h>

#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/sampled_volume.hpp"

namespace palpate {
namespace thin_wall_test {

constexpr double kVoxel = 1e-3;    // [m]
constexpr double kRadius = 20e-3;  // [m]
constexpr double kWall = kVoxel;   // [m]

Vec3 randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

struct Wall {
  Vec3 centre_W;
  AnalyticVolume volume;
};

// The lattice's phase is another in every trial.
Wall randomWall(std::mt19937& random) {
  std::uniform_real_distribution<double> half(-0.5, 0.5);
  const Vec3 centre_W = Vec3::Constant(31.5e-3) + Vec3(half(random), half(random), half(random)) * kVoxel;
  return {centre_W, millimetreVolume(shell(centre_W, kRadius, kWall))};
}

// Every third direction is nearly along an axis: there the wall lies along the lattice, the worst that can be.
Vec3 strokeDirection(std::mt19937& random, int trial) {
  Vec3 out_W = randomDirection(random);
  if (trial % 3 == 0) {
    Vec3 axis = Vec3::Zero();
    axis[(trial / 3) % 3] = trial % 2 == 0 ? 1 : -1;
    out_W = (axis + 0.03 * out_W).normalized();
  }
  return out_W;
}

class ThinWall : public testing::TestWithParam<double> {};

// In from outside to 15 mm behind the wall: 500 N/m are 7.5 N of a device's 8. Then aside, along the wall, behind it.
TEST_P(ThinWall, HoldsWhileTheForceIsWithinTheDevicesLimit) {
  const double step_m = GetParam() * 1e-3;  // at 1 kHz
  std::mt19937 random(11);
  std::uniform_real_distribution<double> phase(0, 1);
  for (int trial = 0; trial < 60; ++trial) {
    const Wall wall = randomWall(random);
    const Vec3 out_W = strokeDirection(random, trial);
    AlgorithmParameters parameters;
    parameters.plane_renewal_ticks = trial % 2 == 0 ? 1 : 5;
    Hri hri(parameters);
    const auto at = [&](double radius_m) { return Vec3(wall.centre_W + out_W * radius_m); };
    double radius_m = kRadius + 2e-3 + phase(random) * step_m;
    AlgorithmDriver driver(hri, wall.volume, at(radius_m));
    driver.around_vhip = true;
    driver.at(at(radius_m));
    while (radius_m > kRadius - 15e-3) {
      radius_m -= step_m;
      const TickOutput out = driver.at(at(radius_m));
      if (radius_m > kRadius - kVoxel) continue;  // in or before the wall
      ASSERT_TRUE(out.in_contact) << "trial " << trial << ", " << (kRadius - radius_m) / kVoxel << " voxels deep";
      ASSERT_GT(out.force_W.dot(out_W), 0) << "trial " << trial;
    }
    // The VHIP goes along the wall at the stroke's speed; the tool follows 3 mm behind.
    const Vec3 aside_W = out_W.cross(randomDirection(random)).normalized();
    driver.stroke(at(kRadius - 3e-3), 12);
    for (double way_m = 0; way_m < 15e-3; way_m += step_m) {
      const double angle = way_m / kRadius;
      const Vec3 here_W = out_W * std::cos(angle) + aside_W * std::sin(angle);
      const TickOutput out = driver.at(wall.centre_W + here_W * (kRadius - 3e-3));
      ASSERT_TRUE(out.in_contact) << "trial " << trial << ", " << way_m / kVoxel << " voxels aside";
      ASSERT_GT(out.force_W.dot(here_W), 0) << "trial " << trial;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MetresPerSecond, ThinWall, testing::Values(0.05, 0.1, 0.2, 0.5, 1.0, 2.0));

// Walls of every thickness, from a fiftieth of a voxel to two, as partial volume makes them: the density is 1 on one
// layer of samples and falls to 0 over one or two voxels, and the isovalue is just below 1. Strokes of every speed,
// from a thousandth of a voxel a tick to eight, oblique, across every axis of lattices of every spacing, turn and hand.
TEST(PartialVolumeWall, IsFeltAndHeldByStrokesOfEverySpeed) {
  Seeded random(12);
  int slow = 0;
  for (int trial = 0; trial < 900; ++trial) {
    const bool cubes = trial % 2 == 0;
    Vec3 spacing_m = Vec3::Constant(kVoxel);
    if (!cubes)
      spacing_m =
          Vec3(random.logBetween(0.3e-3, 3e-3), random.logBetween(0.3e-3, 3e-3), random.logBetween(0.3e-3, 3e-3));
    const int axis = random.pick(3);
    const int fall = 1 + random.pick(2);                       // [voxel]
    const double isovalue = 1 - random.logBetween(0.01, 0.5);  // from 0.5 to 0.99
    const double half_voxel = (1 - isovalue) * fall;           // of the wall's thickness
    AnalyticVolume volume;
    volume.size = Vec3i::Constant(48);
    volume.lattice = latticeAround(random.inCube(0.1), volume.size, spacing_m, random.axes(random.pick(2) == 1),
                                   Vec3::Constant(0.5));
    volume.density = [=, lattice = volume.lattice](const Vec3& p_W) {
      return std::max(0.0, 1 - std::abs(lattice.toIndex(p_W)[axis] - 24) / fall);
    };
    const Vec3 normal_W = volume.lattice.R_WL.col(axis) * (random.pick(2) == 0 ? 1 : -1);
    const Vec3 in_W = (-normal_W + random.across(normal_W) * random.between(0, 1.2)).normalized();
    const double h_m = spacing_m[axis];
    double step_m = random.logBetween(0.001, 8) * volume.lattice.smallestSpacing();
    const int n = static_cast<int>(std::lround(random.logBetween(1, 100)));
    // The middle of the wall is met somewhere in the middle of a face of the lattice.
    Vec3 middle_L = Vec3::Constant(24) + random.inCube(2);
    middle_L[axis] = 24;
    const Vec3 middle_W = volume.lattice.toWorld(middle_L);
    const double slant = -in_W.dot(normal_W);
    // A third of the strokes pass the wall in a tick or miss it by a little: what both ends of a tick do not see.
    if (trial % 3 == 0) {
      const double through_m = 2 * half_voxel * h_m / slant;
      step_m = std::min(8 * volume.lattice.smallestSpacing(), through_m * random.logBetween(0.5, 20));
    }
    const double before_m = (half_voxel + 0.1) * h_m / slant + random.between(0, 1) * step_m;
    const double ticks_behind = std::min(400.0, std::max(4.0, 4 * h_m / step_m));
    Hri hri({.isovalue = isovalue, .damping_Ns_per_m = 0, .plane_renewal_ticks = n});
    AlgorithmDriver driver(hri, volume, middle_W - in_W * before_m);
    driver.around_vhip = true;
    driver.at(middle_W - in_W * before_m);
    SCOPED_TRACE(testing::Message() << "trial " << trial << ", thickness " << 2 * half_voxel << " voxels, "
                                    << step_m / h_m << " voxels a tick, slant " << slant << ", n " << n << ", spacing "
                                    << spacing_m.transpose() << ", axis " << axis << ", isovalue " << isovalue);
    int held = 0;
    for (double way_m = -before_m + step_m; held < ticks_behind; way_m += step_m) {
      const TickOutput out = driver.at(middle_W + in_W * way_m);
      const double depth_voxel = way_m * slant / h_m + half_voxel;
      if (depth_voxel < 0.02) continue;  // in front, or so little behind that sampling in floats decides
      ASSERT_TRUE(out.in_contact) << depth_voxel << " voxels deep, " << faultNames(out.faults);
      ASSERT_GT(out.force_W.dot(normal_W), 0) << depth_voxel << " voxels deep";
      ASSERT_EQ(out.faults & kFadingFaults, 0U) << faultNames(out.faults);
      ++held;
    }
    slow += step_m < 0.25 * h_m ? 1 : 0;
  }
  EXPECT_GT(slow, 200);
}

// The tool far behind the surface, farther than a window reaches: the surface point is what must be in the window.
TEST(DeepPress, IsHeldWhereTheWindowHoldsTheSurface) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 40.4e-3 - p_W.z(); });
  Hri hri(AlgorithmParameters{});
  AlgorithmDriver driver(hri, volume, Vec3(30e-3, 30e-3, 42e-3), 16);
  driver.around_vhip = true;
  driver.at(Vec3(30e-3, 30e-3, 42e-3));
  for (const TickOutput& out : driver.stroke(Vec3(34e-3, 30e-3, 10e-3), 64)) {
    if (!out.in_contact) continue;
    EXPECT_EQ(out.faults, 0U);
    EXPECT_NEAR(out.vhip_W.z(), 40.4e-3, 1e-6 * kVoxel + 1e-8);
  }
  const Vec3 deep_W(34e-3, 30e-3, 10e-3);
  TickOutput out = driver.at(deep_W);
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR(out.force_W.z(), 500 * 30.4e-3, 500 * 1e-7);

  // A window that comes around the tool does not hold the surface; the contact asks for one that does.
  driver.follow = false;
  driver.publish(deep_W);
  for (int i = 0; i < 5; ++i) out = driver.at(deep_W);
  EXPECT_FALSE(out.in_contact);
  EXPECT_TRUE(out.at_surface);
  EXPECT_NEAR(out.surface_W.z(), 40.4e-3, 1e-6);
  driver.follow = true;
  out = driver.at(deep_W);
  EXPECT_TRUE(out.in_contact);
  EXPECT_NEAR(out.force_W.z(), 500 * 30.4e-3, 500 * 1e-7);
}

}  // namespace thin_wall_test
}  // namespace palpate
