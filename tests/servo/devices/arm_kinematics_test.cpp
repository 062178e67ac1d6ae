// SPDX-License-Identifier: Apache-2.0
// The arm against poses that can be read off a drawing, against its own derivative, and against virtual work.
#include "servo/devices/arm_kinematics.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "servo/devices/polhem_device.hpp"

namespace palpate {
namespace arm_kinematics_test {

constexpr double kPi = std::numbers::pi;

const PolhemParameters kPolhem;
const ArmKinematics kArm(kPolhem.joints, kPolhem.origin_m);

// Link b stands up and link c lies flat: 0.133 m out, 0.058 + 0.174 m up, from the foot.
TEST(ArmKinematics, IsAtHomeWhereTheDrawingSays) {
  const Vec3 angles = kArm.angles({0, 0, -5000});
  EXPECT_NEAR(angles[2], kPi / 2, 1e-12);  // 5000 counts of 2000 for a turn, by 10 mm on 100 mm
  const Vec3 position = kArm.position(angles) + kPolhem.origin_m;
  EXPECT_NEAR((position - Vec3(0.133, 0, 0.232)).norm(), 0, 1e-12);
}

// The base turns by a quarter: 0.18 / 0.01 turns of the motor for one of the body, against its sense.
TEST(ArmKinematics, TurnsAboutTheVertical) {
  const std::int64_t quarter = -2000 * 18 / 4;
  const Vec3 position = kArm.position(kArm.angles({quarter, 0, -5000})) + kPolhem.origin_m;
  EXPECT_NEAR((position - Vec3(0, 0.133, 0.232)).norm(), 0, 1e-12);
  std::array<ArmJoint, 3> other = kPolhem.joints;
  other[0].aligned = false;
  const ArmKinematics mirrored(other, kPolhem.origin_m);
  EXPECT_NEAR(mirrored.angles({quarter, 0, 0})[0], -kArm.angles({quarter, 0, 0})[0], 1e-15);
}

// Everything stretched out flat: B = C = 90 degrees.
TEST(ArmKinematics, ReachesAsFarAsItsLinks) {
  const Vec3 position = kArm.position({0, kPi / 2, kPi / 2}) + kPolhem.origin_m;
  EXPECT_NEAR((position - Vec3(0.174 + 0.133, 0, 0.058)).norm(), 0, 1e-12);
  EXPECT_FALSE(kArm.anglesAt(Vec3(0.31, 0, 0.058) - kPolhem.origin_m));
  EXPECT_TRUE(kArm.anglesAt(Vec3(0.306, 0, 0.058) - kPolhem.origin_m));
}

class RandomPoses {
 public:
  Vec3 next() {  // within the workspace's ball
    Vec3 p = Vec3::Constant(1);
    while (p.norm() > 1) p = Vec3(one_(bits_), one_(bits_), one_(bits_));
    return 0.095 * p;
  }

 private:
  std::mt19937 bits_{7};
  std::uniform_real_distribution<double> one_{-1, 1};
};

TEST(ArmKinematics, FindsTheAnglesOfAPosition) {
  RandomPoses poses;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = poses.next();
    const auto angles = kArm.anglesAt(p);
    ASSERT_TRUE(angles);
    EXPECT_NEAR((kArm.position(*angles) - p).norm(), 0, 1e-12);
    const Vec3 rounded = kArm.angles(kArm.countsAt(*angles));
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(rounded[k] - (*angles)[k]), 0.5001 * 2 * kPi / 2000 * 0.1);
  }
}

// Central differences of 1e-5 rad err by less than 1e-10 / 6 times a third derivative of 0.3 m.
TEST(ArmKinematics, HasTheDerivativeOfItsPosition) {
  RandomPoses poses;
  for (int i = 0; i < 200; ++i) {
    const Vec3 angles = kArm.anglesAt(poses.next()).value();
    const Eigen::Matrix3d j = kArm.jacobian(angles);
    for (int k = 0; k < 3; ++k) {
      Vec3 more = angles, less = angles;
      more[k] += 1e-5;
      less[k] -= 1e-5;
      EXPECT_NEAR((j.col(k) - (kArm.position(more) - kArm.position(less)) / 2e-5).norm(), 0, 1e-9);
    }
  }
}

// The motors' work is the handle's: torque times the motor's way for one count is force times the handle's way.
TEST(ArmKinematics, CurrentsDoTheWorkOfTheForce) {
  RandomPoses poses;
  for (int i = 0; i < 200; ++i) {
    const Vec3 angles = kArm.anglesAt(poses.next()).value();
    const Vec3 force(1.5, -2, 0.7);
    const Vec3 currents = kArm.currents(force, angles);
    for (int k = 0; k < 3; ++k) {
      ArmCounts count{};
      count[static_cast<std::size_t>(k)] = 1;
      const Vec3 turn = kArm.angles(count);  // of the bodies, for one count
      const double motor_J = currents[k] * 0.0538 * 2 * kPi / 2000;
      EXPECT_NEAR(motor_J, force.dot(kArm.jacobian(angles) * turn), 1e-15);
    }
    EXPECT_NEAR((kArm.force(currents, angles) - force).norm(), 0, 1e-9);
  }
}

TEST(ArmKinematics, ExertsNothingWhereItCannot) {
  EXPECT_EQ(kArm.force({1, 1, 1}, {0, kPi / 2, kPi / 2}), Vec3::Zero());  // stretched out
  EXPECT_EQ(kArm.force({1, 1, 1}, {0, 0, 0}), Vec3::Zero());
}

// One count of a motor of 2000: at home b moves the handle by 0.174 m times 2 pi / 2000 / 10, c by less, a by less.
TEST(ArmKinematics, ResolvesACount) {
  EXPECT_NEAR(kArm.resolution_m(kArm.angles({0, 0, -5000})), 0.174 * 2 * kPi / 2000 / 10, 1e-12);
}

}  // namespace arm_kinematics_test
}  // namespace palpate
