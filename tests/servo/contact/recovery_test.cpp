// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/recovery.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "contact/plane_contact.hpp"

namespace palpate {
namespace recovery_test {

constexpr int kTicks = 10;       // N
constexpr double kDepth = 1e-3;  // [m]

// An offset is N whole units for each share: off by N / 2 units of 1e-18 m; sums of millimetres in double by 1e-18 m.
constexpr double kRounding_m = kTicks * Recovery::kUnit + 2e-18;

ContactPlane level(double height_m) {
  return {Vec3(0, 0, height_m), Vec3::UnitZ(), 0};
}
ContactPlane tilted(double angle, double height_m = 0) {
  return {Vec3(0, 0, height_m), Vec3(std::sin(angle), 0, std::cos(angle)), 0};
}

// The depth is kept at the switch, grows by an Nth of the jump each tick, and is the true one N ticks after it: to the
// bit.
TEST(Recovery, BringsTheDepthToItsTrueValueLinearly) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const Vec3 hip(0, 0, -kDepth);
  EXPECT_EQ(contact.at(hip), Vec3::Zero());  // first contact: no recovery
  const double rise_m = 0.7e-3;
  contact.renew(level(rise_m));
  for (int k = 0; k < kTicks; ++k) {
    EXPECT_NEAR(contact.at(hip).z(), rise_m * k / kTicks, kRounding_m) << k;
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(contact.at(hip), contact.plane_T.nearest(hip));
    EXPECT_EQ(recovery.offset(), Vec3::Zero());
  }
}

// Depth and direction: d goes along the straight line from D N_old to the new plane's d.
TEST(Recovery, BringsTheDirectionToItsTrueValueToo) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const Vec3 hip(0.2e-3, 0.1e-3, -kDepth);
  const Vec3 before = contact.at(hip) - hip;
  contact.renew(tilted(0.8, 0.3e-3));
  const Vec3 after = contact.plane_T.nearest(hip) - hip;
  for (int k = 0; k <= kTicks; ++k) {
    const double share = static_cast<double>(k) / kTicks;
    EXPECT_NEAR((contact.at(hip) - hip - (before + (after - before) * share)).norm(), 0, kRounding_m) << k;
  }
}

// Over a switch d is what the old plane would have given, also while the tool moves; no other tick steps by more than
// the tool's own motion and |j| / N.
TEST(Recovery, IsContinuousForAMovingTool) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const ContactPlane old = level(0);
  const Vec3 step(0.1e-3, -0.05e-3, -0.02e-3);
  Vec3 hip(0, 0, -kDepth);
  Vec3 d;
  for (int i = 0; i < 5; ++i) d = contact.at(hip += step) - hip;
  contact.renew(tilted(-0.6, 0.2e-3));
  hip += step;
  const double jump_m = (old.nearest(hip) - contact.plane_T.nearest(hip)).norm();
  ASSERT_GT(jump_m, 0.4e-3);
  d = contact.at(hip) - hip;
  EXPECT_NEAR((d - (old.nearest(hip) - hip)).norm(), 0, kRounding_m);
  for (int i = 0; i < 2 * kTicks; ++i) {
    const Vec3 last = d;
    d = contact.at(hip += step) - hip;
    EXPECT_LE((d - last).norm(), jump_m / kTicks + step.norm() + kRounding_m);
  }
  EXPECT_EQ(d, contact.plane_T.nearest(hip) - hip);
}

// Each jump has a ramp of its own: offset = sum of j_i (1 - (k - k_i) / N) over those that are pending.
TEST(Recovery, JumpsSuperpose) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const Vec3 hip(0, 0, -kDepth);
  contact.at(hip);
  const std::vector<std::pair<int, double>> heights = {{0, 0.3e-3}, {3, -0.2e-3}, {4, 0.5e-3}, {12, 0.1e-3}};
  for (int k = 0; k < 30; ++k) {
    double expected_m = 0, height_m = 0;
    for (const auto& [begin, to_m] : heights) {
      if (k < begin) break;
      if (k == begin) contact.renew(level(to_m));
      const double left = std::max(0.0, 1 - static_cast<double>(k - begin) / kTicks);
      expected_m += (height_m - to_m) * left;
      height_m = to_m;
    }
    contact.at(hip);
    EXPECT_NEAR(recovery.offset().z(), expected_m, 4 * kRounding_m) << k;
  }
  EXPECT_EQ(recovery.offset(), Vec3::Zero());
}

// The true surface is 2 mm farther out than the old plane, so 0.2 mm of depth come back each tick. A tool that
// withdraws by w a tick has the depth 0.1 mm + k (0.2 mm - w): with w = 0.3 mm that is negative from the second tick
// on. The contact then does not push, but it does not pull either.
TEST(Recovery, NeverMakesTheDepthNegative) {
  for (const double w : {0.1e-3, 0.19e-3, 0.3e-3}) {
    Recovery recovery(kTicks);
    PlaneContact contact(recovery);
    contact.at({0, 0, -0.1e-3});
    contact.renew(level(2e-3));
    for (int k = 0; k <= 6; ++k) {
      const Vec3 hip(0, 0, -0.1e-3 + k * w);
      const double depth_m = contact.at(hip).z() - hip.z();
      EXPECT_NEAR(depth_m, std::max(0.0, 0.1e-3 + k * (0.2e-3 - w)), kRounding_m) << k;
    }
  }
}

TEST(Recovery, ThePlaneThatIsFoundAgainUnchangedChangesNothing) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  for (const Vec3& hip : wander(1000)) {
    contact.renew(level(0));
    ASSERT_NEAR((contact.at(hip) - contact.plane_T.nearest(hip)).norm(), 0, 1e-17);
  }
}

TEST(Recovery, ANewContactForgetsTheOld) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const Vec3 hip(0, 0, -kDepth);
  contact.at(hip);
  contact.renew(level(1e-3));
  contact.at(hip);
  ASSERT_NE(recovery.offset(), Vec3::Zero());
  contact.leave();
  EXPECT_EQ(recovery.offset(), Vec3::Zero());
  for (int k = 0; k < 2 * kTicks; ++k) EXPECT_EQ(contact.at(hip), contact.plane_T.nearest(hip));
}

// Whole numbers do not drift: after 100,000 random switches, N quiet ticks give the true VHIP, to the bit.
TEST(Recovery, NothingIsLeftOver) {
  Recovery recovery(kTicks);
  PlaneContact contact(recovery);
  const std::vector<Vec3> planes = wander(100'000, 3);
  Vec3 hip;
  for (const Vec3& plane : planes) {
    contact.renew(tilted(300 * plane.x() - std::floor(300 * plane.x()), plane.z()));
    hip = Vec3(plane.y(), plane.x(), -kDepth);
    ASSERT_TRUE(contact.at(hip).allFinite());
  }
  for (int k = 1; k < kTicks; ++k) contact.at(hip);
  EXPECT_EQ(recovery.offset() == Vec3::Zero(), false);
  EXPECT_EQ(contact.at(hip), contact.plane_T.nearest(hip));
  EXPECT_EQ(recovery.offset(), Vec3::Zero());
}

TEST(Recovery, JumpsThatNoSurfaceMakesAreForgotten) {
  for (const double height_m : {1e30, 0.2, std::numeric_limits<double>::infinity(), std::nan("")}) {
    Recovery recovery(kTicks);
    PlaneContact contact(recovery);
    const Vec3 hip(0, 0, -kDepth);
    contact.at(hip);
    contact.renew(level(height_m));
    contact.at(hip);
    EXPECT_EQ(recovery.offset(), Vec3::Zero()) << height_m;
    contact.leave();
    contact.renew(level(0));
    EXPECT_EQ(contact.at(hip), Vec3::Zero());
  }
}

// Jumps of 0.09 m to and fro leave more than they began with as the older ones end; that must not overflow.
TEST(Recovery, HugeJumpsToAndFroStayBounded) {
  Recovery recovery(1000);
  PlaneContact contact(recovery);
  contact.at(Vec3::Zero());
  for (int k = 0; k < 5000; ++k) {
    if (k % 250 == 0) contact.renew(level(k % 500 == 0 ? 0.09 : 0));
    contact.at(Vec3::Zero());
    ASSERT_LE(std::abs(recovery.offset().z()), Recovery::kLongest);
  }
}

TEST(Recovery, OfOneTickIsOverAfterOne) {
  Recovery recovery(1);
  PlaneContact contact(recovery);
  const Vec3 hip(0, 0, -kDepth);
  contact.at(hip);
  contact.renew(level(1e-3));
  EXPECT_NEAR(contact.at(hip).z(), 0, kRounding_m);
  EXPECT_EQ(contact.at(hip).z(), 1e-3);
}

}  // namespace recovery_test
}  // namespace palpate
