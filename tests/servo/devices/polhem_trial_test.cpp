// SPDX-License-Identifier: Apache-2.0
// The pushes of a motor check keep to the limits that forces keep to; motor_check_test.cpp (tests/apps/devices) has
// them on arms that are other ones than they are said to be.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "servo/devices/polhem_device.hpp"
#include "support/polhem_bench.hpp"

namespace palpate {
namespace polhem_trial_test {

// An arm in a hand that holds it firmly, and a push of each motor by all that a check may ask for.
struct Trial {
  explicit Trial(const PolhemParameters& p) : bench(resting(), p, true, firm()) { bench.pass(5); }
  static HandParameters firm() {
    HandParameters hand;
    hand.hand_stiffness_N_per_m = 1e5;
    return hand;
  }
  [[nodiscard]] JointedArm& arm() { return *bench.device.arm(); }
  [[nodiscard]] double pushed_N() const { return said_N; }
  // The force at the handle.
  double push(int motor, double force_N = JointedArm::kMostTrial_N) {
    said_N = arm().push(motor, force_N);
    bench.device.elapse(1);
    return bench.emulated.force_D().norm();
  }
  PolhemBench bench;
  double said_N = 0;
};

// Half a milliampere of a motor is 0.007 N at most here (polhem_device_test.cpp).
constexpr double kRounding_N = 0.01;

// Or a little less: plugged otherwise, the current of motor b would be 1 N.
TEST(PolhemTrial, PushesAsItIsTold) {
  Trial trial(knownPolhem());
  ASSERT_TRUE(trial.arm().canBeTried());
  for (int motor = 0; motor < 3; ++motor) {
    for (const double force_N : {0.03, -0.3, 0.6, 5.0, -5.0}) {
      const double acts_N = trial.push(motor, force_N);
      const double wanted_N = std::clamp(force_N, -JointedArm::kMostTrial_N, JointedArm::kMostTrial_N);
      EXPECT_NEAR(acts_N, std::abs(trial.pushed_N()), kRounding_N) << motor;
      EXPECT_EQ(std::signbit(trial.pushed_N()), std::signbit(wanted_N)) << motor;
      EXPECT_LE(std::abs(trial.pushed_N()), std::abs(wanted_N)) << motor;
      EXPECT_GE(std::abs(trial.pushed_N()), std::min(std::abs(wanted_N), 0.5)) << motor;
    }
    EXPECT_EQ(trial.push(motor, std::nan("")), 0);
    EXPECT_EQ(trial.pushed_N(), 0);
  }
}

TEST(PolhemTrial, KeepsToTheForceLimitOfItsKind) {
  PolhemParameters p = knownPolhem();
  p.force_limit_N = 0.2;
  Trial trial(p);
  for (int motor = 0; motor < 3; ++motor) {
    EXPECT_NEAR(trial.push(motor), 0.2, kRounding_N) << motor;
    EXPECT_DOUBLE_EQ(trial.pushed_N(), 0.2) << motor;
  }
}

TEST(PolhemTrial, KeepsToTheCurrentLimit) {
  PolhemParameters p = knownPolhem();
  p.current_limit_A = 0.03;
  Trial trial(p);
  for (int motor = 0; motor < 3; ++motor) {
    EXPECT_LT(trial.push(motor), 0.5) << motor;
    EXPECT_NEAR(trial.bench.emulated.currents_A().cwiseAbs().maxCoeff(), 0.03, 1e-9) << motor;
    EXPECT_NEAR(trial.pushed_N(), trial.bench.emulated.force_D().norm(), kRounding_N) << motor;
  }
}

// Where next to nothing may be pushed nothing is, and no check begins.
TEST(PolhemTrial, PushesNothingWhereNothingWouldBeSeen) {
  PolhemParameters p = knownPolhem();
  p.force_limit_N = 0.01;
  Trial trial(p);
  EXPECT_FALSE(trial.arm().canBeTried());
  for (int motor = 0; motor < 3; ++motor) EXPECT_EQ(trial.push(motor), 0) << motor;
}

// Pushed for as long as one likes, a motor gets no hotter than it bears. The sum of its own is off by less than
// i^2 dt / tau / 2, and half a milliampere of rounding by 2 i 0.5e-3 (polhem_heat_test.cpp).
TEST(PolhemTrial, KeepsToWhatItsMotorsBear) {
  constexpr double kContinuous_A = 0.02, kHeating_s = 1, kLimit_A = 0.1;
  PolhemParameters p = knownPolhem();
  p.continuous_current_A = kContinuous_A;
  p.heating_s = kHeating_s;
  Trial trial(p);
  double heat_A2 = 0, hottest_A2 = 0, largest_A = 0;
  for (int tick = 0; tick < 5000; ++tick) {
    trial.push(0);
    const double current_A = trial.bench.emulated.currents_A().cwiseAbs().maxCoeff();
    heat_A2 += kPolhemTick_s / kHeating_s * (current_A * current_A - heat_A2);
    hottest_A2 = std::max(hottest_A2, heat_A2);
    largest_A = std::max(largest_A, current_A);
  }
  EXPECT_GT(largest_A, 1.2 * kContinuous_A) << "a cold motor may have more";
  EXPECT_LT(largest_A, kLimit_A);
  EXPECT_LE(hottest_A2, kContinuous_A * kContinuous_A + kLimit_A * kLimit_A * kPolhemTick_s / 2 + 2 * kLimit_A * 5e-4);
}

}  // namespace polhem_trial_test
}  // namespace palpate
