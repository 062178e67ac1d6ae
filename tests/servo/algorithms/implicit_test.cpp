// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/implicit.hpp"

#include <gtest/gtest.h>

#include "level_leap.hpp"
#include "servo/safety/faults.hpp"
#include "support/algorithm_driver.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {
namespace implicit_test {

constexpr double kVoxel = 1e-3;
const Vec3 kCentre = Vec3::Constant(31.3e-3);
const AlgorithmParameters kNoDamping{0, 500, 0, 1};

Vec3 onBall(double angle, double radius_m) {
  return kCentre + Vec3(std::cos(angle), 0.2, std::sin(angle)).normalized() * radius_m;
}

// The HIP comes to rest: each pass leaves depth / R of what it was aside, 2 of 20 voxels, so ten ticks leave nothing
// and the contact point is on the sampled isosurface (sag h^2 / (4 R) = 0.0125) under the HIP.
TEST(Implicit, TheContactPointConvergesUnderTheHip) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, volume, onBall(0, 21e-3), 64);
  driver.follow = false;
  driver.at(onBall(0, 21e-3));
  driver.stroke(onBall(0.2, 18e-3), 10);
  TickOutput out;
  for (int i = 0; i < 10; ++i) out = driver.at(onBall(0.2, 18e-3));
  ASSERT_TRUE(out.in_contact);
  EXPECT_LT((out.vhip_W - onBall(0.2, 20e-3)).norm(), 0.0125 * kVoxel + 2e-3 * samplingBound(18).radians);
  EXPECT_LT((out.normal_W - (onBall(0.2, 20e-3) - kCentre).normalized()).norm(), samplingBound(19).radians);
}

// Over level ground a leap aside is followed by a voxel in each pass.
TEST(Implicit, GetsAsFarAsATickAllows) {
  expectToGetAsFarAsATickAllows<Implicit>(ImplicitSurface::kMaxPasses * kVoxel);
}

// The tangent plane holds a HIP that got through; contact begins only where S has the HIP inside.
TEST(Implicit, HoldsOnTheOtherSideOfAPlateAndMissesOneThatIsJumped) {
  const AnalyticVolume plate = millimetreVolume([](const Vec3& p_W) { return 2e-3 - std::abs(p_W.z() - 30.3e-3); });
  const auto z = [](double z_m) { return Vec3(30e-3, 30e-3, z_m); };
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, plate, z(34e-3), 64);
  driver.follow = false;
  driver.at(z(34e-3));
  const TickOutput out = driver.at(z(31.5e-3));
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR(out.vhip_W.z(), 32.3e-3, 0.01 * kVoxel);
  const TickOutput through = driver.at(z(27e-3));
  EXPECT_NEAR(through.vhip_W.z(), 32.3e-3, 0.01 * kVoxel);
  EXPECT_NEAR(through.force_W.z(), 500 * 5.3e-3, 500 * 0.01 * kVoxel);
  EXPECT_FALSE(driver.at(z(34e-3)).in_contact);
  EXPECT_FALSE(driver.at(z(26e-3)).in_contact);  // jumped
}

// The contact point comes from where it was, so inside the plate it keeps to its own side past the middle.
TEST(Implicit, TheTangentPlaneKeepsToItsSide) {
  const AnalyticVolume plate = millimetreVolume([](const Vec3& p_W) { return 2e-3 - std::abs(p_W.z() - 30.3e-3); });
  const auto z = [](double z_m) { return Vec3(30e-3, 30e-3, z_m); };
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, plate, z(34e-3), 64);
  driver.follow = false;
  driver.at(z(34e-3));
  for (const TickOutput& out : driver.stroke(z(28.5e-3), 30)) {
    if (!out.in_contact) continue;
    ASSERT_NEAR(out.vhip_W.z(), 32.3e-3, 0.01 * kVoxel);
  }
  EXPECT_TRUE(driver.at(z(28.5e-3)).in_contact);
}

// The surface goes away with no way out in reach: transparent, with a fault, until the tool has been outside once.
TEST(Implicit, GivesNoForceWhenItHasLostTheSurface) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, 20e-3));
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return 0.1 + p_W.z(); });
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, before, onBall(0, 21e-3), 64);
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
TEST(Implicit, FindsASurfaceThatAnEditMovedByTheNearestWayOut) {
  for (const double added_m : {6e-3, 16e-3}) {
    const AnalyticVolume before = millimetreVolume(ball(kCentre, 12e-3));
    const AnalyticVolume after = millimetreVolume(ball(kCentre, 12e-3 + added_m));
    Implicit implicit(kNoDamping);
    AlgorithmDriver driver(implicit, before, onBall(0, 13e-3), 64);
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

// After the edit the surface is 31 voxels away and a cut face of the volume 12; this algorithm does not feel cut faces.
TEST(Implicit, ACutFaceIsNoWayOut) {
  const AnalyticVolume before = millimetreVolume([](const Vec3& p_W) { return p_W.x() - 50e-3; });
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return p_W.x() - 20e-3; });
  const auto at = [](double x_m) { return Vec3(x_m, 30e-3, 30e-3); };
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, before, at(49e-3), 64);
  driver.follow = false;
  driver.at(at(49e-3));
  ASSERT_TRUE(driver.at(at(51e-3)).in_contact);
  driver.edit(after);
  EXPECT_EQ(driver.at(at(51e-3)).faults, bit(ServoFault::kSurfaceLost));
  EXPECT_FALSE(driver.at(at(51e-3)).in_contact);
}

TEST(Implicit, AFlatFieldIsLostWithItsReason) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, volume, onBall(0, 21e-3), 64);
  driver.follow = false;
  driver.at(onBall(0, 21e-3));
  HeldWindow flat;
  volume.hold(flat, Vec3i::Zero(), Vec3i::Constant(64), 7);
  for (Sample& s : flat.samples) s.gradient_i = s.gradient_j = s.gradient_k = 0;
  TickOutput out;
  implicit.tick({onBall(0, 19e-3), Vec3::Zero(), &flat.window}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kSurfaceLost) | bit(ServoFault::kZeroGradient));
  EXPECT_TRUE(out.force_W.isZero(0));
}

TEST(Implicit, StartingInsideGivesNoForceUntilOutsideOnce) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, 20e-3));
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, volume, onBall(0, 18e-3), 64);
  driver.follow = false;
  EXPECT_EQ(driver.at(onBall(0, 18e-3)).faults, bit(ServoFault::kInsideObject));
  EXPECT_EQ(driver.at(onBall(0, 21e-3)).faults, 0u);
  EXPECT_TRUE(driver.at(onBall(0, 19e-3)).in_contact);
}

TEST(Implicit, NoForceWhereTheWindowDoesNotReach) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, volume, Vec3(30e-3, 30e-3, 31e-3), 16);
  driver.follow = false;
  driver.at(Vec3(30e-3, 30e-3, 31e-3));
  ASSERT_TRUE(driver.at(Vec3(30e-3, 30e-3, 29e-3)).in_contact);
  const TickOutput out = driver.at(Vec3(45e-3, 30e-3, 29e-3));  // samples end at 37 mm
  EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_TRUE(out.at_surface);
  EXPECT_NEAR(out.surface_W.z(), 30.4e-3, 1e-6);
  EXPECT_NEAR(driver.at(Vec3(31e-3, 30e-3, 29e-3)).force_W.z(), 0.7, 1e-3);
  SampleWindow nothing;
  TickOutput none;
  implicit.tick({Vec3(31e-3, 30e-3, 29e-3), Vec3::Zero(), &nothing}, none);
  EXPECT_EQ(none.faults, bit(ServoFault::kNoWindow));
}

TEST(Implicit, ACutFaceOfTheVolumeIsNotFelt) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 40e-3 - p_W.z(); });
  Implicit implicit(kNoDamping);
  AlgorithmDriver driver(implicit, volume, Vec3(65e-3, 30e-3, 20e-3), 64);
  driver.follow = false;
  driver.at(Vec3(65e-3, 30e-3, 20e-3));
  EXPECT_FALSE(driver.at(Vec3(61e-3, 30e-3, 20e-3)).in_contact);
}

}  // namespace implicit_test
}  // namespace palpate
