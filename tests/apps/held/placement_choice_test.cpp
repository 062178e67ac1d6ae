// SPDX-License-Identifier: Apache-2.0
#include "apps/held/placement_choice.hpp"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace placement_choice_test {

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<>(low, high)(random_); }
  int whole(int low, int high) { return std::uniform_int_distribution<>(low, high)(random_); }
  Vec3 vector(double most) { return {between(-most, most), between(-most, most), between(-most, most)}; }

 private:
  std::mt19937 random_;
};

Lattice anyLattice(Dice& dice) {
  Lattice lattice;
  lattice.origin_W = dice.vector(0.3);
  lattice.spacing_m = Vec3(dice.between(1e-4, 3e-3), dice.between(1e-4, 3e-3), dice.between(1e-4, 3e-3));
  const Vec3 axis = dice.vector(1).normalized();
  lattice.R_WL = Eigen::AngleAxisd(dice.between(0, 3.1), axis).toRotationMatrix();
  if (dice.whole(0, 1) == 1) lattice.R_WL.col(1) *= -1;  // InVesalius flips an axis
  return lattice;
}

// Against every voxel's centre. 1e-12 m: rounding of sums of a metre at most, a thousand times.
TEST(PlacementChoice, TheBoxIsThatOfAllVoxels) {
  Dice dice(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Lattice lattice = anyLattice(dice);
    const Eigen::Vector3i size(dice.whole(1, 9), dice.whole(1, 9), dice.whole(1, 9));
    Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
    for (int k = 0; k < size.z(); ++k) {
      for (int j = 0; j < size.y(); ++j) {
        for (int i = 0; i < size.x(); ++i) {
          low = low.cwiseMin(lattice.toWorld(Vec3(i, j, k)));
          high = high.cwiseMax(lattice.toWorld(Vec3(i, j, k)));
        }
      }
    }
    const VolumeBox box = boxOf(lattice, size);
    EXPECT_LT((box.middle_W - box.half_W - low).cwiseAbs().maxCoeff(), 1e-12) << trial;
    EXPECT_LT((box.middle_W + box.half_W - high).cwiseAbs().maxCoeff(), 1e-12) << trial;
  }
}

// A device's point d is at at_W + scale R d. So every voxel is within reach, whatever the turn, and no workspace is
// made smaller than it is.
TEST(PlacementChoice, TheWorkspaceHoldsTheVolume) {
  Dice dice(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const VolumeBox box{dice.vector(1), dice.vector(0.4).cwiseAbs()};
    const DeviceLimits device{.workspace_radius_m = dice.between(0.01, 0.3)};
    Scene scene;
    if (dice.whole(0, 1) == 1) scene.place_turn_rad = dice.vector(3.1);
    const Placement placement = placementOf(scene, device, box);
    EXPECT_TRUE(placement.R_WD.isUnitary(1e-12));
    EXPECT_NEAR(placement.R_WD.determinant(), 1, 1e-12);
    EXPECT_GE(placement.scale, 1);
    const Vec3 corner_W = box.middle_W + box.half_W;
    const Vec3 at_D = placement.R_WD.transpose() * (corner_W - placement.at_W) / placement.scale;
    EXPECT_LE(at_D.norm(), device.workspace_radius_m * (1 + 1e-12));
    const bool as_large_as_needed = placement.scale == 1 || at_D.norm() > device.workspace_radius_m * (1 - 1e-12);
    EXPECT_TRUE(as_large_as_needed);
  }
}

// In front, that is towards the user: outside the box along that direction, whatever the turn.
TEST(PlacementChoice, ADeviceThatNoForceMovesBeginsInFrontOfTheVolume) {
  Dice dice(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const VolumeBox box{dice.vector(1), dice.vector(0.4).cwiseAbs()};
    Scene scene;
    if (dice.whole(0, 1) == 1) scene.place_turn_rad = dice.vector(3.1);
    const Placement placement = placementOf(scene, {.follows_force = false}, box);
    const Vec3 to_user_W = placement.R_WD * Vec3::UnitZ();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const Vec3 corner_W = box.middle_W + box.half_W.cwiseProduct(sign);
      EXPECT_GT((placement.at_W - corner_W).dot(to_user_W), 9e-3) << trial;
    }
  }
}

TEST(PlacementChoice, WhatTheSceneSaysIsTaken) {
  Scene scene;
  scene.place_at_W = Vec3(1, 2, 3);
  scene.place_scale = 0.25;
  scene.place_turn_rad = Vec3(0, 0, 1.5);
  scene.force_scale = 3;
  scene.no_clutch = true;
  scene.edge_stiffness_N_per_m = 7;
  const Placement placement = placementOf(scene, {.workspace_radius_m = 0.01}, {Vec3(9, 9, 9), Vec3(1, 1, 1)});
  EXPECT_EQ(placement.at_W, Vec3(1, 2, 3));
  EXPECT_EQ(placement.scale, 0.25);
  EXPECT_TRUE(placement.R_WD.isApprox(Eigen::AngleAxisd(1.5, Vec3::UnitZ()).toRotationMatrix()));
  EXPECT_EQ(placement.force_scale, 3);
  EXPECT_FALSE(placement.clutch);
  EXPECT_EQ(placement.edge_stiffness_N_per_m, 7);
}

// First about x, then about the world's y, then about its z.
TEST(PlacementChoice, TurnsAreAboutTheWorldsAxesOneAfterAnother) {
  Scene scene;
  constexpr double kQuarter = 1.5707963267948966;
  scene.place_turn_rad = Vec3(kQuarter, kQuarter, 0);
  const Placement placement = placementOf(scene, {}, {});
  // y -> z about x, and z -> x about y.
  EXPECT_TRUE((placement.R_WD * Vec3::UnitY()).isApprox(Vec3::UnitX(), 1e-12));
}

}  // namespace placement_choice_test
}  // namespace palpate
