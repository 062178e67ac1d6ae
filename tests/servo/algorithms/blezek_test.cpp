// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/blezek.hpp"

#include <gtest/gtest.h>

#include "level_leap.hpp"
#include "servo/safety/faults.hpp"
#include "servo/window/window_sampler.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {
namespace blezek_test {

constexpr double kVoxel = 1e-3;
const Vec3 kCentre = Vec3::Constant(31.3e-3);
const AlgorithmParameters kNoDamping{0, 500, 0, 1};

Vec3 onBall(double angle, double radius_m) {
  return kCentre + Vec3(std::cos(angle), 0.2, std::sin(angle)).normalized() * radius_m;
}

// What the method promises: the normal at the VHIP is the direction from the HIP to it. The normal that it went by is
// from before the last Newton step, at most kOnSurface long, which on a knot of 5 voxels of radius turns it by less
// than 1e-2 / 5 radians.
TEST(Blezek, InchesUntilNormalAndLineAgree) {
  const TorusKnot knot(kCentre, 31e-3, 6e-3);
  const AnalyticVolume volume = sampledVolume(knot.surface());
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, volume, knot.below(0.2, 0, -1e-3), 64);
  driver.follow = false;
  driver.at(knot.below(0.2, 0, -1e-3));
  for (int i = 0; i < 400; ++i) {
    const Vec3 hip_W = knot.below(0.2 + 2e-3 * i, 0.02 * i, 1.5e-3);
    const TickOutput out = driver.at(hip_W);
    ASSERT_TRUE(out.in_contact) << i;
    const Vec3 normal_W = -fetch(driver.window(), out.vhip_W).gradient_W.normalized();
    ASSERT_LT(normal_W.cross((out.vhip_W - hip_W).normalized()).norm(), BlezekSurface::kAlignment + 2e-3) << i;
  }
}

// A HIP that goes any way around the ball in a tick, at any depth, has its VHIP there in the same tick: the inches
// follow the way, and those to settle leave it aligned to kAlignment, beside what sampling does to the normal. The way
// around is a little longer than that along the first plane; what is missing of it is left to the next tick.
TEST(Blezek, FollowsAsFarAsTheHipWent) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  for (const double depth_m : {0.5e-3, 2e-3, 6e-3}) {
    for (const double angle : {0.01, 0.05, 0.1, 0.2, 0.4, 0.6}) {
      Blezek blezek(kNoDamping);
      AlgorithmDriver driver(blezek, volume, onBall(0, 21e-3), 64);
      driver.follow = false;
      driver.at(onBall(0, 21e-3));
      driver.at(onBall(0, 20e-3 - depth_m));
      const Vec3 hip_W = onBall(angle, 20e-3 - depth_m);
      const Vec3 true_W = onBall(angle, 20e-3);
      TickOutput out = driver.at(hip_W);
      ASSERT_TRUE(out.in_contact);
      EXPECT_LT((out.vhip_W - true_W).norm(), angle <= 0.2 ? 0.05 * kVoxel : 0.1 * angle * 20e-3) << depth_m << angle;
      out = driver.at(hip_W);
      EXPECT_LT((out.vhip_W - true_W).norm(), 0.03 * kVoxel) << depth_m << " " << angle;
    }
  }
}

// A tool that has leapt around a ball farther than the inches of a tick leaves the VHIP behind by the rest. An inch d
// along the tangent turns the normal by atan(d / R); one more would turn it by 1.1 degrees, and sampling turns it by
// less than half of that.
TEST(Blezek, GoesNoFartherInATickThanItsMostInches) {
  constexpr double kRadius = 26e-3;
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, kRadius));
  Blezek blezek(kNoDamping);
  const auto at = [&](double angle, double radius_m) {
    return Vec3(kCentre + Vec3(std::cos(angle), 0, std::sin(angle)) * radius_m);
  };
  AlgorithmDriver driver(blezek, volume, at(0, kRadius + 1e-3), 64);
  driver.follow = false;
  driver.at(at(0, kRadius + 1e-3));
  ASSERT_TRUE(driver.at(at(0, kRadius - 1e-3)).in_contact);
  const TickOutput out = driver.at(at(1.3, kRadius - 1e-3));
  ASSERT_TRUE(out.in_contact);
  const double inch_rad = std::atan(BlezekSurface::kInch * kVoxel / kRadius);
  EXPECT_NEAR(std::atan2(out.normal_W.z(), out.normal_W.x()), BlezekSurface::kMaxInches * inch_rad, 0.45 * inch_rad);
}

// Over level ground a leap aside is followed by inches.
TEST(Blezek, GetsAsFarAsATickAllows) {
  expectToGetAsFarAsATickAllows<Blezek>(BlezekSurface::kMaxInches * BlezekSurface::kInch * kVoxel);
}

TEST(Blezek, HoldsAHipThatHasGoneThroughAPlate) {
  const AnalyticVolume plate = millimetreVolume([](const Vec3& p_W) { return 2e-3 - std::abs(p_W.z() - 30.3e-3); });
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, plate, Vec3(30e-3, 30e-3, 34e-3), 64);
  driver.follow = false;
  driver.at(Vec3(30e-3, 30e-3, 34e-3));
  const TickOutput out = driver.at(Vec3(30e-3, 30e-3, 25e-3));  // both ends of the tick outside
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR(out.vhip_W.z(), 32.3e-3, 0.01 * kVoxel);
  EXPECT_FALSE(driver.at(Vec3(30e-3, 30e-3, 33e-3)).in_contact);
}

// The surface goes away with no way out in reach: transparent, with a fault, until the tool has been outside once.
TEST(Blezek, GivesNoForceWhenItHasLostTheSurface) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, 20e-3));
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return 0.1 + p_W.z(); });
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, before, onBall(0, 21e-3), 64);
  driver.follow = false;
  driver.at(onBall(0, 21e-3));
  ASSERT_TRUE(driver.at(onBall(0, 19e-3)).in_contact);
  driver.edit(after);
  const TickOutput out = driver.at(onBall(0, 19e-3));
  EXPECT_EQ(out.faults, bit(ServoFault::kSurfaceLost));
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_EQ(driver.at(onBall(0, 19e-3)).faults, bit(ServoFault::kSurfaceLost));
  driver.edit(before);
  EXPECT_EQ(driver.at(onBall(0, 19e-3)).faults, bit(ServoFault::kSurfaceLost));
  EXPECT_EQ(driver.at(onBall(0, 21e-3)).faults, 0u);
  EXPECT_TRUE(driver.at(onBall(0, 19e-3)).in_contact);
}

// An edit moves the surface by 6 voxels, which the contact point follows, or by 16, which is too far for its steps: the
// tool is pushed towards the new one, gently.
TEST(Blezek, FindsASurfaceThatAnEditMovedByTheNearestWayOut) {
  for (const double added_m : {6e-3, 16e-3}) {
    const AnalyticVolume before = millimetreVolume(ball(kCentre, 12e-3));
    const AnalyticVolume after = millimetreVolume(ball(kCentre, 12e-3 + added_m));
    Blezek blezek(kNoDamping);
    AlgorithmDriver driver(blezek, before, onBall(0, 13e-3), 64);
    driver.follow = false;
    driver.at(onBall(0, 13e-3));
    const double before_N = driver.at(onBall(0, 11e-3)).force_W.norm();
    driver.edit(after);
    TickOutput out = driver.at(onBall(0, 11e-3));
    EXPECT_EQ(out.faults, 0u);
    EXPECT_NEAR(out.force_W.norm(), before_N + 500 * added_m / 500, 500 * 0.02 * kVoxel);
    for (int i = 0; i < 500; ++i) out = driver.at(onBall(0, 11e-3));
    EXPECT_LT((out.vhip_W - onBall(0, 12e-3 + added_m)).norm(), 0.02 * kVoxel);
  }
}

TEST(Blezek, AFlatFieldIsLostWithItsReason) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, volume, onBall(0, 21e-3), 64);
  driver.follow = false;
  driver.at(onBall(0, 21e-3));
  HeldWindow flat;
  volume.hold(flat, Vec3i::Zero(), Vec3i::Constant(64), 7);
  for (Sample& s : flat.samples) s.gradient_i = s.gradient_j = s.gradient_k = 0;
  TickOutput out;
  blezek.tick({onBall(0, 19e-3), Vec3::Zero(), &flat.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kSurfaceLost) | bit(ServoFault::kZeroGradient));
  EXPECT_TRUE(out.force_W.isZero(0));
}

TEST(Blezek, StartingInsideGivesNoForceUntilOutsideOnce) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, volume, onBall(0, 18e-3), 64);
  driver.follow = false;
  EXPECT_EQ(driver.at(onBall(0, 18e-3)).faults, bit(ServoFault::kInsideObject));
  EXPECT_FALSE(driver.at(onBall(0, 19e-3)).in_contact);
  EXPECT_EQ(driver.at(onBall(0, 21e-3)).faults, 0u);
  EXPECT_TRUE(driver.at(onBall(0, 19e-3)).in_contact);
}

// What was touched is remembered while the window does not hold the VHIP, and says where the window belongs; a gap in
// free motion is searched afterwards.
TEST(Blezek, NoForceWhereTheWindowDoesNotReach) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, volume, Vec3(30e-3, 30e-3, 31e-3), 16);
  driver.follow = false;
  driver.at(Vec3(30e-3, 30e-3, 31e-3));
  ASSERT_TRUE(driver.at(Vec3(30e-3, 30e-3, 29e-3)).in_contact);
  const TickOutput out = driver.at(Vec3(45e-3, 30e-3, 29e-3));  // samples end at 37 mm
  EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_TRUE(out.at_surface);
  EXPECT_NEAR(out.surface_W.z(), 30.4e-3, 1e-6);  // as far as the samples go
  EXPECT_NEAR(driver.at(Vec3(31e-3, 30e-3, 29e-3)).force_W.z(), 0.7, 1e-3);
  driver.at(Vec3(31e-3, 30e-3, 31e-3));
  EXPECT_TRUE(has(driver.at(Vec3(45e-3, 30e-3, 29e-3)).faults, ServoFault::kBeyondWindow));
  driver.publish(Vec3(40e-3, 30e-3, 29e-3));
  EXPECT_TRUE(driver.at(Vec3(45e-3, 30e-3, 29e-3)).in_contact);
}

TEST(Blezek, MaterialPutOverAFreeToolPushesItOutTheNearestWay) {
  const AnalyticVolume before = millimetreVolume([](const Vec3&) { return -1.0; });
  const AnalyticVolume after = millimetreVolume(ball(kCentre, 20e-3));
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, before, onBall(0, 15e-3), 64);
  driver.follow = false;
  driver.at(onBall(0, 15e-3));
  driver.edit(after);
  TickOutput out = driver.at(onBall(0, 15e-3));
  EXPECT_EQ(out.faults, 0u);
  EXPECT_LE(out.force_W.norm(), 500 * 5e-3 / 500 + 500 * 0.02 * kVoxel);
  for (int i = 0; i < 500; ++i) out = driver.at(onBall(0, 15e-3));
  EXPECT_LT((out.vhip_W - onBall(0, 20e-3)).norm(), 0.02 * kVoxel);
}

TEST(Blezek, ACutFaceOfTheVolumeIsNotFelt) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 40e-3 - p_W.z(); });
  Blezek blezek(kNoDamping);
  AlgorithmDriver driver(blezek, volume, Vec3(65e-3, 30e-3, 20e-3), 64);
  driver.follow = false;
  driver.at(Vec3(65e-3, 30e-3, 20e-3));
  EXPECT_FALSE(driver.at(Vec3(61e-3, 30e-3, 20e-3)).in_contact);
  EXPECT_FALSE(driver.at(Vec3(60e-3, 30e-3, 20e-3)).in_contact);
}

TEST(Blezek, NoWindow) {
  Blezek blezek(kNoDamping);
  blezek.reset(Vec3::Zero());
  const SampleWindow nothing;
  TickOutput out;
  blezek.tick({Vec3::Zero(), Vec3::Zero(), &nothing}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kNoWindow));
}

}  // namespace blezek_test
}  // namespace palpate
