// SPDX-License-Identifier: Apache-2.0
// A contact that is lost with the tool in the object is told in every tick until the tool has been outside, and the
// gate lets the force fall over its fade time.
#include <gtest/gtest.h>

#include "servo/algorithms/hri.hpp"
#include "servo/safety/safety_gate.hpp"
#include "support/algorithm_driver.hpp"

namespace palpate {
namespace lost_contact_test {

constexpr int kSide = 160;  // more than a window, and than IsoField::kLongestWayOut, reaches
const Vec3 kOnSurface_W = Vec3::Constant(80.3e-3);
constexpr double kDepth = 4e-3;
constexpr double kForce_N = 500 * kDepth;

AnalyticVolume floorAt(double top_m) {
  return millimetreVolume([=](const Vec3& p_W) { return std::clamp(top_m - p_W.z(), -2e-3, 2e-3); }, kSide);
}
Vec3 above(double height_m) {
  return kOnSurface_W + Vec3(0, 0, height_m);
}

class LostContact : public testing::TestWithParam<int> {
 protected:
  // The force that leaves the gate.
  double sent(const TickOutput& out) {
    const Vec3 force_W = gate.pass({out.force_W, 0, out.faults}).force_W;
    gate.taken(force_W);
    return force_W.norm();
  }
  // Pressed until the force is whole.
  void press() {
    driver.at(above(1e-3));
    for (const TickOutput& out : driver.stroke(above(-kDepth), 50)) last_N = sent(out);
    ASSERT_NEAR(last_N, kForce_N, 500 * 0.01e-3);
  }

  AnalyticVolume ground = floorAt(80.3e-3);
  AnalyticVolume full = millimetreVolume([](const Vec3&) { return 2e-3; }, kSide);
  AnalyticVolume empty = millimetreVolume([](const Vec3&) { return -2e-3; }, kSide);
  Hri hri{{.damping_Ns_per_m = 0, .plane_renewal_ticks = GetParam()}};
  AlgorithmDriver driver{hri, ground, above(1e-3)};
  SafetyGate gate{{.force_limit_N = 8, .slew_limit_N_per_s = 20000, .fade_s = 0.05}, 1000};
  double last_N = 0;
};

// An edit makes everything in reach object.
TEST_P(LostContact, IsToldInEveryTickAndTheForceFades) {
  press();
  driver.edit(full);
  const double step_N = kForce_N / static_cast<double>(gate.fadeTicks());
  ASSERT_EQ(gate.fadeTicks(), 50);
  for (int tick = 0; tick < 200; ++tick) {
    const TickOutput out = driver.at(above(-kDepth + 1e-6 * tick));
    ASSERT_TRUE(has(out.faults, ServoFault::kSurfaceLost)) << tick << " " << faultNames(out.faults);
    ASSERT_FALSE(has(out.faults, ServoFault::kInsideObject)) << tick;
    ASSERT_FALSE(out.in_contact);
    ASSERT_TRUE(out.force_W.isZero(0));
    const double now_N = sent(out);
    ASSERT_NEAR(now_N, std::max(0.0, last_N - step_N), 1e-9) << tick;
    last_N = now_N;
  }
}

// Deeper than a window around the surface shows: nothing is known of the place of the tool, and the force fades as
// well.
TEST_P(LostContact, IsToldBelowTheWindowToo) {
  constexpr double kDeep = 24e-3;
  driver.around_vhip = true;
  driver.at(above(1e-3));
  for (const TickOutput& out : driver.stroke(above(-kDeep), 250)) last_N = sent(out);
  ASSERT_NEAR(last_N, 8, 1e-9);  // the gate's limit
  driver.edit(full);
  const double step_N = 8.0 / static_cast<double>(gate.fadeTicks());
  for (int tick = 0; tick < 200; ++tick) {
    const TickOutput out = driver.at(above(-kDeep + 1e-6 * tick));
    ASSERT_NE(out.faults & kFadingFaults, 0U) << tick << " " << faultNames(out.faults);
    ASSERT_FALSE(has(out.faults, ServoFault::kInsideObject)) << tick;
    ASSERT_TRUE(out.force_W.isZero(0));
    if (tick != 1) {  // the driver's window has followed by then
      ASSERT_TRUE(has(out.faults, ServoFault::kSurfaceLost)) << tick << " " << faultNames(out.faults);
    }
    const double now_N = sent(out);
    ASSERT_NEAR(now_N, std::max(0.0, last_N - step_N), 1e-9) << tick;
    last_N = now_N;
  }
}

// The surface comes back, but the tool is still in the object: lost as before. Out once, and it is touched as any.
TEST_P(LostContact, IsOverWhenTheToolHasBeenOutside) {
  press();
  driver.edit(full);
  for (int tick = 0; tick < 60; ++tick) static_cast<void>(sent(driver.at(above(-kDepth))));
  driver.edit(ground);
  const int ticks = 60;
  for (int tick = 1; tick <= ticks; ++tick) {
    const double height_m = -kDepth + (kDepth + 0.97e-3) * tick / ticks;
    const TickOutput out = driver.at(above(height_m));
    ASSERT_EQ(out.faults, height_m < 0 ? bit(ServoFault::kSurfaceLost) : 0U) << tick << " " << faultNames(out.faults);
    ASSERT_FALSE(out.in_contact);
  }
  for (const TickOutput& out : driver.stroke(above(-kDepth), 60)) {
    ASSERT_EQ(out.faults, 0U);
    last_N = sent(out);
  }
  EXPECT_NEAR(last_N, kForce_N, 500 * 0.01e-3);
}

// The same edit under a tool that is free, or with the tool then outside, is no lost surface.
TEST_P(LostContact, IsNoneWhereTheEditLeavesTheToolOutside) {
  press();
  driver.edit(empty);
  for (int tick = 0; tick < 5; ++tick) {
    const TickOutput out = driver.at(above(-kDepth));
    ASSERT_EQ(out.faults, 0U) << faultNames(out.faults);
    ASSERT_TRUE(out.force_W.isZero(0));
  }
  // Buried now, without a way out: inside the object, but no surface was lost.
  driver.edit(full);
  for (int tick = 0; tick < 5; ++tick) {
    ASSERT_EQ(driver.at(above(-kDepth)).faults, bit(ServoFault::kInsideObject)) << tick;
  }
}

// A reset forgets it: the tool is inside at the start.
TEST_P(LostContact, IsForgottenByAReset) {
  press();
  driver.edit(full);
  EXPECT_TRUE(has(driver.at(above(-kDepth)).faults, ServoFault::kSurfaceLost));
  hri.reset(above(-kDepth));
  EXPECT_EQ(driver.at(above(-kDepth)).faults, bit(ServoFault::kInsideObject));
}

INSTANTIATE_TEST_SUITE_P(Ticks, LostContact, testing::Values(1, 5, 1000));

// Taken over from another algorithm 30 mm above a HIP that lies so deep that its window shows object only. There is no
// entry to be seen, so there is no force, and every tick says why, until the HIP has been outside.
TEST_P(LostContact, AnEntryThatNoWindowShowsIsToldToo) {
  hri.resume(above(10e-3), above(-20e-3));
  driver.publish(above(-20e-3));
  for (int tick = 0; tick < 20; ++tick) {
    const TickOutput out = driver.at(above(-20e-3));
    EXPECT_TRUE(has(out.faults, ServoFault::kInsideObject)) << tick << " " << faultNames(out.faults);
    EXPECT_TRUE(out.force_W.isZero(0));
  }
  driver.stroke(above(1e-3), 100);
  EXPECT_TRUE(driver.stroke(above(-kDepth), 50).back().in_contact);
}

}  // namespace lost_contact_test
}  // namespace palpate
