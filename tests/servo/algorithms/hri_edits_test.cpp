// SPDX-License-Identifier: Apache-2.0
// hri while the volume is edited under the tool: surfaces that move, go, or bury it.
#include "ball_slide.hpp"
#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace hri_edits_test {

// The surface moves out over VHIP and HIP: the force stays outward, is at first what it was, and has the new depth when
// that is taken in.
TEST(Hri, FindsTheSurfaceWhenVhipAndHipAreBothInside) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, 18e-3));
  const AnalyticVolume after = millimetreVolume(ball(kCentre, 25e-3));
  Hri hri(AlgorithmParameters{});
  AlgorithmDriver driver(hri, before, slidePoint(0, 19e-3));
  driver.at(slidePoint(0, 19e-3));
  const Vec3 hip_W = slidePoint(0, 17e-3);
  ASSERT_NEAR(driver.at(hip_W).force_W.norm(), 500 * 1e-3, 1.1);  // with the damping of the approach
  driver.edit(after);
  const TickOutput first = driver.at(hip_W);
  ASSERT_TRUE(first.in_contact);
  EXPECT_EQ(first.plane_age_ticks, 0);
  // A tick's share of what the edit added is there already: 500 N/m of 7 mm / 500.
  EXPECT_NEAR((first.vhip_W - hip_W).norm(), 1e-3 + 7e-3 / kEaseTicks, 0.02 * kVoxel);
  const TickOutput out = holdUntilEased(driver, hip_W, first, 7e-3);
  EXPECT_NEAR((out.vhip_W - hip_W).norm(), 8e-3, 0.02 * kVoxel);
  EXPECT_LT(degreesBetween(out.force_W, hip_W - kCentre), 0.5);
}

// A plateau 20 voxels deep is put over the tool. Newton has no gradient to follow, so the search along N must find the
// new surface.
TEST(Hri, SearchesAlongTheNormalWhereTheFieldIsFlat) {
  const auto plateau = [](double top_m) {
    return [=](const Vec3& p_W) { return std::clamp(top_m - p_W.z(), -1.5e-3, 1.5e-3); };
  };
  const AnalyticVolume before = millimetreVolume(plateau(25e-3));
  const AnalyticVolume after = millimetreVolume(plateau(37e-3));
  Hri hri(AlgorithmParameters{});
  AlgorithmDriver driver(hri, before, Vec3(30e-3, 30e-3, 25.5e-3));
  driver.at(Vec3(30e-3, 30e-3, 25.5e-3));
  const Vec3 hip_W(30e-3, 30e-3, 24.5e-3);
  ASSERT_TRUE(driver.at(hip_W).in_contact);
  driver.edit(after);
  const TickOutput first = driver.at(hip_W);
  ASSERT_TRUE(first.in_contact);
  EXPECT_NEAR(first.vhip_W.z(), 25e-3, 12e-3 / kEaseTicks + 0.01 * kVoxel);
  const TickOutput out = holdUntilEased(driver, hip_W, first, 12e-3);
  EXPECT_NEAR(out.vhip_W.z(), 37e-3, 0.01 * kVoxel);
  EXPECT_LT(degreesBetween(out.force_W, Vec3::UnitZ()), 0.1);
}

TEST(Hri, AnEditThatRemovesTheSurfaceLetsGoAtOnce) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, kRadius));
  const AnalyticVolume after = millimetreVolume([](const Vec3&) { return -1.0; });
  AlgorithmParameters p;
  p.plane_renewal_ticks = 1000;
  Hri hri(p);
  AlgorithmDriver driver(hri, before, slidePoint(0, 25e-3));
  driver.at(slidePoint(0, 25e-3));
  ASSERT_TRUE(driver.at(slidePoint(0, 23e-3)).in_contact);
  driver.edit(after);
  const TickOutput out = driver.at(slidePoint(0, 23e-3));
  EXPECT_FALSE(out.in_contact);
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_EQ(out.faults, 0u);
}

// Drilled half a millimetre under the tool: the plane follows although n is far off.
TEST(Hri, AnEditThatLowersTheSurfaceRenewsThePlaneNow) {
  const AnalyticVolume before = millimetreVolume(ball(kCentre, kRadius));
  const AnalyticVolume after = millimetreVolume(ball(kCentre, kRadius - 0.5e-3));
  AlgorithmParameters p;
  p.plane_renewal_ticks = 1000;
  Hri hri(p);
  AlgorithmDriver driver(hri, before, slidePoint(0, 25e-3));
  driver.at(slidePoint(0, 25e-3));
  driver.at(slidePoint(0, 23e-3));
  driver.edit(after);
  const TickOutput out = driver.at(slidePoint(0, 23e-3));
  ASSERT_TRUE(out.in_contact);
  EXPECT_NEAR((out.vhip_W - kCentre).norm(), kRadius - 0.5e-3, 0.02 * kVoxel);
}

// Material put over a free tool pushes it out by the nearest way, from no force on.
TEST(Hri, BuriedByAnEditIsPushedOutGently) {
  const AnalyticVolume before = millimetreVolume([](const Vec3&) { return -1.0; });
  const AnalyticVolume after = millimetreVolume(ball(kCentre, kRadius));
  Hri hri(AlgorithmParameters{});
  const Vec3 hip_W = slidePoint(0, 15e-3);
  AlgorithmDriver driver(hri, before, hip_W);
  driver.at(hip_W);
  driver.edit(after);
  const TickOutput first = driver.at(hip_W);
  ASSERT_TRUE(first.in_contact);
  EXPECT_FALSE(has(first.faults, ServoFault::kInsideObject));
  EXPECT_LE(first.force_W.norm(), 500 * 9e-3 / kEaseTicks + 1e-9);
  const TickOutput out = holdUntilEased(driver, hip_W, first, 9e-3);
  EXPECT_NEAR(out.force_W.norm(), 500 * 9e-3, 500 * 0.02 * kVoxel);
  EXPECT_LT(degreesBetween(out.force_W, hip_W - kCentre), 0.5);
  // Once out, the tool is free, and touches the new surface as any.
  driver.stroke(slidePoint(0, 25e-3), 50);
  EXPECT_FALSE(driver.at(slidePoint(0, 25e-3)).in_contact);
  driver.stroke(slidePoint(0, 23e-3), 50);
  EXPECT_NEAR(driver.at(slidePoint(0, 23e-3)).force_W.norm(), 500 * 1e-3, 500 * 0.02 * kVoxel);
}

// A tool that pulls out before the depth is taken in feels no pull, and nothing once it is out.
TEST(Hri, LeavingWhileItIsPushedOutNeverPulls) {
  const AnalyticVolume before = millimetreVolume([](const Vec3&) { return -1.0; });
  const AnalyticVolume after = millimetreVolume(ball(kCentre, kRadius));
  Hri hri(AlgorithmParameters{});
  AlgorithmDriver driver(hri, before, slidePoint(0, 20e-3));
  driver.at(slidePoint(0, 20e-3));
  driver.edit(after);
  for (const TickOutput& out : driver.stroke(slidePoint(0, 25e-3), 100)) {
    EXPECT_GE(out.force_W.dot(slidePoint(0, 1) - kCentre), 0);
    EXPECT_LE(out.force_W.norm(), 500 * 4e-3);
  }
  EXPECT_FALSE(driver.at(slidePoint(0, 25e-3)).in_contact);
}

// Everything within reach is object: no way out, no force, and nothing is thrown.
TEST(Hri, BuriedWithoutAWayOutFeelsNothing) {
  const AnalyticVolume before = millimetreVolume([](const Vec3&) { return -1.0; });
  const AnalyticVolume after = millimetreVolume([](const Vec3&) { return 1.0; });
  Hri hri(AlgorithmParameters{});
  AlgorithmDriver driver(hri, before, kCentre);
  driver.at(kCentre);
  driver.edit(after);
  const TickOutput out = driver.at(kCentre);
  EXPECT_FALSE(out.in_contact);
  EXPECT_TRUE(out.force_W.isZero(0));
  EXPECT_TRUE(has(out.faults, ServoFault::kInsideObject));
}

}  // namespace hri_edits_test
}  // namespace palpate
