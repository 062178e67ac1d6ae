// SPDX-License-Identifier: Apache-2.0
// hri where the window is late, elsewhere or missing.
#include "ball_slide.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace hri_windows_test {

// Windows of another run may have the versions and the storage of the last one's: after a reset nothing is known of
// them.
TEST(Hri, AResetForgetsTheWindow) {
  const AnalyticVolume volume = millimetreVolume(ball(kCentre, kRadius));
  AnalyticVolume larger = millimetreVolume(ball(kCentre, kRadius));
  larger.lattice.spacing_m *= 2;  // the same samples, twice as far apart
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(64));
  SampleWindow second = held.window;
  second.lattice = larger.lattice;
  Hri hri(everyTick());
  hri.reset(slidePoint(0, kRadius + 1e-3));
  TickOutput out;
  hri.tick({slidePoint(0, kRadius + 1e-3), Vec3::Zero(), &held.window}, out);
  const Vec3 out_W = (slidePoint(0, 1) - kCentre).normalized();
  const auto at = [&](double radius_m) { return Vec3(2 * kCentre + radius_m * out_W); };
  hri.reset(at(2 * kRadius + 1e-3));
  hri.tick({at(2 * kRadius + 1e-3), Vec3::Zero(), &second}, out);
  hri.tick({at(2 * kRadius - 1e-3), Vec3::Zero(), &second}, out);
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR(out.force_W.norm(), 500 * 1e-3, 500 * 0.03 * kVoxel);  // the sag of samples of 2 mm: h^2 / (4 R)
}

TEST(Hri, NoForceWithoutAWindow) {
  Hri hri(AlgorithmParameters{});
  hri.reset(Vec3::Zero());
  SampleWindow nothing;
  TickOutput out;
  hri.tick({Vec3::Zero(), Vec3::Zero(), &nothing}, out);
  EXPECT_EQ(out.faults, bit(ServoFault::kNoWindow));
  EXPECT_TRUE(out.force_W.isZero(0));
}

// The window stays behind: no force and a fault. It catches up: contact again, on the same side, without falling in.
TEST(Hri, BeyondTheWindowThereIsNoForceAndTheContactIsRemembered) {
  const AnalyticVolume volume = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  for (int n : {1, 5}) {
    AlgorithmParameters p;
    p.plane_renewal_ticks = n;
    Hri hri(p);
    AlgorithmDriver driver(hri, volume, Vec3(30e-3, 30e-3, 31e-3), 16);
    driver.follow = false;
    driver.at(Vec3(30e-3, 30e-3, 31e-3));
    ASSERT_TRUE(driver.at(Vec3(30e-3, 30e-3, 29e-3)).in_contact);
    TickOutput out;
    for (int i = 0; i < n; ++i) out = driver.at(Vec3(45e-3, 30e-3, 29e-3));
    EXPECT_TRUE(has(out.faults, ServoFault::kBeyondWindow));
    EXPECT_FALSE(out.in_contact);
    EXPECT_TRUE(out.force_W.isZero(0));
    driver.publish(Vec3(45e-3, 30e-3, 29e-3));
    for (int i = 0; i < 3; ++i) out = driver.at(Vec3(45e-3, 30e-3, 29e-3));
    EXPECT_TRUE(out.in_contact);
    EXPECT_EQ(out.faults, 0u);
    EXPECT_NEAR(out.vhip_W.z(), 30.4e-3, 0.01 * kVoxel);
  }
}

// Free at one place, then for a tick beyond the window, then in the object under a window that holds both places.
struct Gap {
  static inline const Vec3 kFree_W{30e-3, 30e-3, 40e-3};
  static inline const Vec3 kHip_W{30e-3, 30e-3, 28e-3};
  static inline const Vec3 kBoth_W{30e-3, 30e-3, 35e-3};       // middle of a window that holds both
  static inline const Vec3 kElsewhere_W{52e-3, 50e-3, 12e-3};  // of one that holds neither

  AnalyticVolume before = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  Hri hri{{.damping_Ns_per_m = 0}};
  AlgorithmDriver driver{hri, before, kFree_W, 16};

  Gap() {
    driver.follow = false;
    EXPECT_EQ(driver.at(kFree_W).faults, 0U);
  }
  void hide(const Vec3& window_W, const Vec3& hip_W = kHip_W) {
    driver.publish(window_W);
    const TickOutput out = driver.at(hip_W);
    EXPECT_EQ(out.faults, bit(ServoFault::kBeyondWindow));
    EXPECT_FALSE(out.in_contact);
  }
  TickOutput catchUp(const Vec3& window_W = kBoth_W, const Vec3& hip_W = kHip_W) {
    driver.publish(window_W);
    return driver.at(hip_W);
  }
};

TEST(Hri, AGapInFreeMotionIsSearchedAfterwards) {
  Gap gap;
  gap.hide(Gap::kElsewhere_W);
  const TickOutput out = gap.catchUp();
  EXPECT_TRUE(out.in_contact);
  EXPECT_EQ(out.faults, 0U);
  EXPECT_NEAR(out.vhip_W.z(), 30.4e-3, 0.01 * kVoxel);
}

TEST(Hri, AGapThatIsTooLongIsNotSearched) {
  static_assert(HriSurface::kLongestGap == 16);
  for (const double gap_m : {15.9e-3, 16.1e-3}) {
    Gap gap;
    const Vec3 hip_W = Gap::kFree_W - Vec3(0, 0, gap_m);
    gap.hide(Gap::kElsewhere_W, hip_W);
    const TickOutput out = gap.catchUp(Gap::kBoth_W - Vec3(0, 0, 4e-3), hip_W);
    EXPECT_EQ(out.in_contact, gap_m < 16e-3);
    EXPECT_EQ(out.faults, gap_m < 16e-3 ? 0U : bit(ServoFault::kInsideObject));
  }
}

// The edit comes in a window that holds neither place, and buries none: the way is searched in the volume as it is now.
TEST(Hri, AfterAnEditDuringAGapTheWayIsSearchedInTheNewVolume) {
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return 29.4e-3 - p_W.z(); });
  Gap gap;
  gap.hide(Gap::kElsewhere_W);
  gap.driver.edit(after);
  gap.hide(Gap::kElsewhere_W);
  const TickOutput first = gap.catchUp();
  EXPECT_EQ(first.faults, 0U);
  const TickOutput out = holdUntilEased(gap.driver, Gap::kHip_W, first, 1.4e-3);
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR(out.vhip_W.z(), 29.4e-3, 0.01 * kVoxel);
}

// The edit buries both places. Between them is nothing but object, flat, so the free point is no place to come from;
// the nearest way out is aside. Where the window of the edit holds the free point, it is known at once, else
// afterwards.
TEST(Hri, AnEditDuringAGapThatBuriesTheFreePointPushesTheToolOutGently) {
  const AnalyticVolume after =
      millimetreVolume([](const Vec3& p_W) { return std::clamp(p_W.x() - 25.6e-3, -1.5e-3, 1.5e-3); });
  for (const Vec3& window_W : {Gap::kElsewhere_W, Gap::kFree_W}) {
    SCOPED_TRACE(testing::Message() << "window of the edit around " << window_W.transpose());
    Gap gap;
    gap.hide(Gap::kElsewhere_W);
    gap.driver.publish(window_W);
    gap.driver.edit(after);
    gap.hide(window_W);
    const TickOutput first = gap.catchUp();
    ASSERT_TRUE(first.in_contact) << faultNames(first.faults);
    EXPECT_FALSE(has(first.faults, ServoFault::kInsideObject));
    EXPECT_LE(first.force_W.norm(), 500 * 4.4e-3 / kEaseTicks + 1e-9);
    const TickOutput out = holdUntilEased(gap.driver, Gap::kHip_W, first, 4.4e-3);
    EXPECT_LT((out.force_W - Vec3(-500 * 4.4e-3, 0, 0)).norm(), 500 * 0.02 * kVoxel);
  }
}

// Buried during a gap, with no way out in reach: no force until the tool has been outside.
TEST(Hri, AnEditDuringAGapThatLeavesNoWayOutGivesNoForce) {
  const AnalyticVolume after = millimetreVolume([](const Vec3&) { return 1.0; });
  for (const Vec3& window_W : {Gap::kElsewhere_W, Gap::kFree_W}) {
    Gap gap;
    gap.hide(Gap::kElsewhere_W);
    gap.driver.publish(window_W);
    gap.driver.edit(after);
    gap.hide(window_W);
    for (int tick = 0; tick < 5; ++tick) {
      const TickOutput out = gap.catchUp();
      ASSERT_FALSE(out.in_contact);
      ASSERT_EQ(out.faults, bit(ServoFault::kInsideObject)) << faultNames(out.faults);
    }
  }
}

// The edit comes while the window does not reach the tool: what it added is not there at once when the window has
// caught up, though that window's version is no news any more.
TEST(Hri, AnEditDuringALateWindowIsTakenInAfterwards) {
  const AnalyticVolume before = millimetreVolume([](const Vec3& p_W) { return 30.4e-3 - p_W.z(); });
  const AnalyticVolume after = millimetreVolume([](const Vec3& p_W) { return 34.4e-3 - p_W.z(); });
  Hri hri({.damping_Ns_per_m = 0, .plane_renewal_ticks = 1});
  AlgorithmDriver driver(hri, before, Vec3(30e-3, 30e-3, 31e-3), 16);
  driver.follow = false;
  driver.at(Vec3(30e-3, 30e-3, 31e-3));
  ASSERT_TRUE(driver.at(Vec3(30e-3, 30e-3, 29e-3)).in_contact);
  const Vec3 hip_W(45e-3, 30e-3, 29e-3);
  driver.at(hip_W);
  driver.edit(after);
  EXPECT_TRUE(has(driver.at(hip_W).faults, ServoFault::kBeyondWindow));
  driver.publish(hip_W);
  double last_N = 0;
  for (int i = 0; i < kEaseTicks + 1; ++i) {
    const TickOutput out = driver.at(hip_W);
    ASSERT_TRUE(out.in_contact) << i;
    ASSERT_LE(out.force_W.norm() - last_N, 500 * 5.4e-3 / kEaseTicks + 1e-6) << i;
    last_N = out.force_W.norm();
  }
  EXPECT_NEAR(last_N, 500 * 5.4e-3, 500 * 0.01 * kVoxel);
}

}  // namespace hri_windows_test
}  // namespace palpate
