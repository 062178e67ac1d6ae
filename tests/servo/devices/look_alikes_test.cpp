// SPDX-License-Identifier: Apache-2.0
// The most that currents can be at the handle, against all orders and directions of three motors of each arm.
#include "servo/devices/look_alikes.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/seeded.hpp"

namespace palpate {
namespace look_alikes_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

LookAlikes::Arm anyArm(Seeded& random) {
  std::array<ArmJoint, 3> joints;
  for (ArmJoint& joint : joints) {
    joint.length_m = random.between(0.1, 0.25);
    joint.torque_Nm_per_A = random.logBetween(0.01, 0.4);
    joint.aligned = random.pick(2) == 0;
  }
  return {ArmKinematics(joints, Vec3::Zero()),
          {0, random.pick(6000) - 3000, random.pick(6000) - 3000},
          {-kInfinity, -kInfinity, -kInfinity},
          {kInfinity, kInfinity, kInfinity}};
}

Vec3 anglesOf(const LookAlikes::Arm& arm, const LookAlikes::Arm& first, const ArmCounts& counts) {
  ArmCounts own = counts;
  for (std::size_t k = 0; k < 3; ++k) own[k] += arm.home_counts[k] - first.home_counts[k];
  return arm.arm.angles(own);
}

// What these currents are at the handle of an arm, in the worst order and directions; 0 where it is stretched out.
double worst_N(const ArmKinematics& arm, const Vec3& angles, const Vec3& currents_A) {
  std::array<int, 3> order = {0, 1, 2};
  double most_N = 0;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Vec3 plugged_A;
      for (int k = 0; k < 3; ++k)
        plugged_A[order[static_cast<std::size_t>(k)]] = ((signs >> k & 1) ? -1 : 1) * currents_A[k];
      most_N = std::max(most_N, arm.force(plugged_A, angles).norm());
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return most_N;
}

TEST(LookAlikes, BoundsWhatCurrentsAreOnEachArmHoweverItIsPlugged) {
  Seeded random(5);
  double tightest = 0;
  for (int i = 0; i < 1000; ++i) {
    std::vector<LookAlikes::Arm> arms;
    for (int k = 0; k < 1 + random.pick(4); ++k) arms.push_back(anyArm(random));
    const LookAlikes all(arms);
    const ArmCounts counts = {random.pick(2000) - 1000, random.pick(8000) - 4000, random.pick(8000) - 4000};
    const Vec3 currents_A = random.inCube(1), alone_A = random.between(-1, 1) * Vec3::Unit(random.pick(3));
    double worst = 0, worst_alone = 0;
    for (const LookAlikes::Arm& arm : arms) {
      worst = std::max(worst, worst_N(arm.arm, anglesOf(arm, arms[0], counts), currents_A));
      worst_alone = std::max(worst_alone, worst_N(arm.arm, anglesOf(arm, arms[0], counts), alone_A));
    }
    ASSERT_GE(all.most_N(currents_A, counts), worst * (1 - 1e-9)) << i;
    ASSERT_EQ(all.mostOfPossible_N(currents_A, counts), all.most_N(currents_A, counts)) << i;
    tightest = std::max(tightest, worst / all.most_N(currents_A, counts));
    // Of one motor the bound is what it is.
    ASSERT_NEAR(all.most_N(alone_A, counts), worst_alone, 1e-9 * worst_alone) << i;
  }
  EXPECT_GT(tightest, 0.9);
}

// An arm whose joints cannot be there is none of those that it may be; a little beyond its range it still may be.
TEST(LookAlikes, LeavesOutWhatCannotBe) {
  Seeded random(6);
  LookAlikes::Arm own = anyArm(random), other = own;
  std::array<ArmJoint, 3> strong;
  strong.fill({.torque_Nm_per_A = 10});
  other.arm = ArmKinematics(strong, Vec3::Zero());
  const ArmCounts counts = own.arm.countsAt(Vec3(0.1, 0.5, 0.6));
  const double turned_rad = anglesOf(other, own, counts)[1];
  const Vec3 currents_A(0.1, 0.2, 0.3);
  const double alone_N = LookAlikes({own}).most_N(currents_A, counts);
  const double both_N = LookAlikes({own, other}).most_N(currents_A, counts);
  ASSERT_GT(both_N, 2 * alone_N);
  for (const auto& [beyond_rad, may_be] : {std::pair(-0.5, true), std::pair(0.04, true), std::pair(0.06, false)}) {
    other.highest_rad[1] = turned_rad - beyond_rad;
    const LookAlikes pair({own, other});
    EXPECT_EQ(pair.mostOfPossible_N(currents_A, counts), may_be ? both_N : alone_N) << beyond_rad;
    EXPECT_EQ(pair.most_N(currents_A, counts), both_N) << beyond_rad;
    EXPECT_TRUE(pair.isPossible(counts));
    EXPECT_EQ(LookAlikes({other, own})
                  .isPossible({counts[0] + other.home_counts[0] - own.home_counts[0],
                               counts[1] + other.home_counts[1] - own.home_counts[1],
                               counts[2] + other.home_counts[2] - own.home_counts[2]}),
              beyond_rad <= 0)
        << beyond_rad;
  }
}

TEST(LookAlikes, KnowsNoBoundWhereOneIsStretchedOut) {
  Seeded random(7);
  const LookAlikes arms({anyArm(random)});
  const ArmCounts stretched = {0, 0, 0};  // both links upright
  EXPECT_EQ(arms.most_N(Vec3(1e-6, 0, 0), stretched), kInfinity);
  EXPECT_EQ(arms.most_N(Vec3::Zero(), stretched), 0);
}

}  // namespace look_alikes_test
}  // namespace palpate
