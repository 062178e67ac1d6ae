// SPDX-License-Identifier: Apache-2.0
// How stiff a surface may be, with everything that the linear limit leaves out: near that limit where little is left
// out, and what the passivity controller makes of it.
#include "apps/stability/z_width.hpp"

#include <gtest/gtest.h>

#include "apps/stability/study_device.hpp"
#include "servo/devices/typical_hands.hpp"

namespace palpate {
namespace z_width_test {

const WallVolume& ball() {
  static const WallVolume kBall(WallVolume::Shape::kBall);
  return kBall;
}

WidthQuestion question(const StudyDevice& device, const TypicalHand& hand, double damping_Ns_per_m) {
  WidthQuestion asked;
  asked.contact.wall.damping_Ns_per_m = damping_Ns_per_m;
  asked.device = held(device, hand.holding(bare(device)));
  return asked;
}

// The default device has no encoders and no delay. What is left is that the tool may leave the surface, which a
// contact near the limit does when it lands, and the ball: so the width lies below the limit, and not far.
TEST(ZWidth, OfTheDefaultDeviceIsALittleLessThanTheLinearLimit) {
  const StudyDevice& device = studyDevices().front();
  for (const TypicalHand& hand : kTypicalHands) {
    for (const double damping : {0.0, 0.5, 2.0, 5.0, 20.0}) {
      const WidthQuestion asked = question(device, hand, damping);
      const double limit = stiffnessBound({.hand = asked.device.dynamics}, damping);
      const Width found = width(asked, ball());
      EXPECT_GT(found.stiffness_N_per_m, 0.7 * limit) << hand.name << " B " << damping;
      EXPECT_LT(found.stiffness_N_per_m, 1.03 * limit) << hand.name << " B " << damping;
      EXPECT_LE(found.force_max_N, device.force_limit_N);
    }
  }
}

TEST(ZWidth, IsWhereTheToolBeginsToShake) {
  const WidthQuestion asked = question(studyDevices().front(), kTypicalHands[1], 0.5);
  const double found = width(asked, ball()).stiffness_N_per_m;
  EXPECT_LE(restlessness(asked, found, ball()), kQuiet_m);
  EXPECT_GT(restlessness(asked, found * (1 + kWidthPrecision), ball()), kQuiet_m);
  EXPECT_LE(restlessness(asked, 0.5 * found, ball()), kQuiet_m);
}

// At any damping that the default device has use for, in the default hand; the force stays within its limit.
TEST(ZWidth, TheControllerMakesItThreeTimesAsLarge) {
  const StudyDevice& device = studyDevices().front();
  for (const double damping : {0.0, 0.5, 2.0}) {
    WidthQuestion asked = question(device, kTypicalHands[1], damping);
    const double without = width(asked, ball()).stiffness_N_per_m;
    asked.passivity.control = true;
    const Width with = width(asked, ball());
    EXPECT_GT(with.stiffness_N_per_m, 3 * without) << damping;
    EXPECT_LE(with.force_max_N, device.force_limit_N);
  }
}

TEST(ZWidth, IsNothingWhereNoSurfaceIsQuiet) {
  WidthQuestion asked = question(studyDevices().front(), kTypicalHands[1], 0);
  asked.contact.wall.damping_Ns_per_m = 1000;
  EXPECT_EQ(width(asked, ball()).stiffness_N_per_m, 0);
}

}  // namespace z_width_test
}  // namespace palpate
