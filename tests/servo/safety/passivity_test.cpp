// SPDX-License-Identifier: Apache-2.0
// A wall on the side x < 0, depth -x, force K depth outwards, held over each tick. Pressed in by `n` ticks of `a`
// metres and out again, it gives away K a^2 n: with the force held from the tick's start, it takes 0 + 1 + .. + (n-1)
// and gives n + (n-1) + .. + 1 times K a^2.
#include "servo/safety/passivity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/devices/hand_dynamics.hpp"

namespace palpate {
namespace passivity_test {

constexpr double kTick_s = 1e-3;
constexpr double kStep_m = 20e-6;
constexpr int kSteps = 50;
constexpr double kStiffness = 2000;  // [N/m]
const double kUnit_J = kStiffness * kStep_m * kStep_m;
// Sums of some 100 terms, the largest n K a^2.
const double kRounding_J = 100 * kSteps * kUnit_J * std::numeric_limits<double>::epsilon();

double depthOfTick(int k) {
  return kStep_m * std::max(0, kSteps - std::abs(k - kSteps));
}

struct Course {
  double least_J = 0, end_J = 0;
};

// The wall with damping (of the backward difference) and a delay, in the wall's own computing or in the device.
Course press(double damping_Ns_per_m, int wall_delay_ticks, int device_delay_ticks = 0) {
  Passivity passivity({}, 8, 1 / kTick_s, device_delay_ticks);
  passivity.reset(Vec3::Zero());
  Course course;
  for (int k = 0; k <= 2 * kSteps + wall_delay_ticks + device_delay_ticks + 1; ++k) {
    passivity.moved(Vec3(-depthOfTick(k), 0, 0));
    course.least_J = std::min(course.least_J, passivity.energy_J());
    const int from = k - wall_delay_ticks;
    const double rate = (depthOfTick(from) - depthOfTick(from - 1)) / kTick_s;
    const double force_N = kStiffness * depthOfTick(from) + (depthOfTick(from) > 0 ? damping_Ns_per_m * rate : 0);
    passivity.hold(Vec3(force_N, 0, 0));
  }
  course.end_J = passivity.energy_J();
  return course;
}

TEST(PassivityObserver, ASampledSpringGivesAwayItsLeakExactly) {
  EXPECT_NEAR(press(0, 0).end_J, -kSteps * kUnit_J, kRounding_J);
}

// K depth(k - d) times the way: -K a^2 (n (1 + 2 d) - 3 d (d + 1) / 2), the sum of both arithmetic series, whether the
// wall is late or the device.
TEST(PassivityObserver, ADelayMakesTheLeakWorse) {
  for (const int d : {1, 2, 5}) {
    const double expected_J = -kUnit_J * (kSteps * (1 + 2 * d) - 1.5 * d * (d + 1));
    EXPECT_NEAR(press(0, d).end_J, expected_J, kRounding_J) << d;
    EXPECT_NEAR(press(0, 0, d).end_J, expected_J, kRounding_J) << d;
  }
}

// A damper B takes B a^2 / T a tick but in the first, and gives it in the one after the turn: (2 n - 3) B a^2 / T. With
// B = K T that is 2 n - 3 leaks of K a^2 against n, and nowhere on the way is E below zero; with a quarter of it the
// leak wins.
TEST(PassivityObserver, ADampedWallWithinTheLimitStaysPassive) {
  const Course passive = press(kStiffness * kTick_s, 0);
  EXPECT_GE(passive.least_J, -kRounding_J);
  EXPECT_NEAR(passive.end_J, kUnit_J * (2 * kSteps - 3 - kSteps), kRounding_J);
  const Course active = press(0.25 * kStiffness * kTick_s, 0);
  EXPECT_NEAR(active.end_J, kUnit_J * (0.25 * (2 * kSteps - 3) - kSteps), kRounding_J);
  EXPECT_LT(active.least_J, -kRounding_J);
}

// A way of several ticks in one, as after missed deadlines: the force was held all the while.
TEST(PassivityObserver, AHeldForceActsOverTheWholeWay) {
  Passivity passivity({}, 8, 1000);
  passivity.reset(Vec3(0, 0, 1e-3));
  passivity.hold(Vec3(0, 3, 2));
  passivity.moved(Vec3(5e-3, 1e-3, -2e-3));
  EXPECT_DOUBLE_EQ(passivity.energy_J(), -(3 * 1e-3 - 2 * 3e-3));
}

TEST(PassivityObserver, OverMissingPositionsTheMeanForceCounts) {
  Passivity passivity({}, 8, 1000);
  passivity.reset(Vec3::Zero());
  for (const double force_N : {4.0, 3.0, 2.0}) passivity.hold(Vec3(force_N, 0, 0));
  passivity.moved(Vec3(1e-3, 0, 0));
  EXPECT_DOUBLE_EQ(passivity.energy_J(), -3e-3);
}

TEST(PassivityObserver, AWayThatIsNoNumberIsLeftOut) {
  Passivity passivity({}, 8, 1000);
  passivity.reset(Vec3::Zero());
  passivity.hold(Vec3(8, 0, 0));
  passivity.moved(Vec3(std::numeric_limits<double>::max(), 0, 0));  // 8 times that is infinite
  EXPECT_EQ(passivity.energy_J(), 0);
}

// A metre is the longest way that is a motion.
TEST(PassivityObserver, AWayOfMoreThanAMetreIsAWrongReading) {
  for (const double way_m : {0.99, 1.01}) {
    Passivity passivity({}, 8, 1000);
    passivity.reset(Vec3::Zero());
    passivity.hold(Vec3(0, 2, 0));
    passivity.moved(Vec3(0, -way_m, 0));
    EXPECT_DOUBLE_EQ(passivity.energy_J(), way_m < 1 ? 2 * way_m : 0);
    // Either way the next one begins there.
    passivity.hold(Vec3(0, 2, 0));
    passivity.moved(Vec3(0, -way_m - 0.5, 0));
    EXPECT_DOUBLE_EQ(passivity.energy_J(), way_m < 1 ? 2 * (way_m + 0.5) : 1);
  }
}

// A step of the encoders after a rest acts up to the edge that was crossed, half a step; the second one, four ticks
// later without a position between, from there to an eighth beyond the next edge (encoder_position.hpp).
TEST(PassivityObserver, FollowsTheToolBehindItsEncoders) {
  Passivity passivity({}, 8, 1000, 0, 1e-3);
  passivity.reset(Vec3::Zero());
  passivity.hold(Vec3(2, 0, 0));
  passivity.moved(Vec3(-1e-3, 0, 0));
  EXPECT_NEAR(passivity.energy_J(), 2 * 0.5e-3, 1e-8);
  for (int i = 0; i < 4; ++i) passivity.hold(Vec3(3, 0, 0));
  passivity.moved(Vec3(-2e-3, 0, 0));
  EXPECT_NEAR(passivity.energy_J(), 2 * 0.5e-3 + 3 * 1.125e-3, 1e-8);
}

// ---- controller ----

constexpr double kMass_kg = 0.1, kFriction_Ns_per_m = 0.5, kStartSpeed_m_per_s = 0.05;
constexpr double kLeak_Ns_per_m = kStiffness * kTick_s / 2;  // what sampling takes from the damping: 1 N s/m
const double kFrequency_rad_per_s = std::sqrt(kStiffness / kMass_kg);

struct Loop {
  double least_J = 0;
  double greatest_step_m = 0;
  double greatest_added_N = 0;
  std::vector<double> peaks_m;  // largest |x| in each tenth of the run
};

// A mass on a spring that the servo renders, K x, with less friction than K T / 2: m 0.1 kg, b 0.5 against 1 N s/m.
// Exact between the ticks (hand_dynamics.hpp).
Loop oscillate(bool control) {
  const HandDynamics dynamics({.hand_mass_kg = 0,
                               .hand_damping_Ns_per_m = 0,
                               .hand_stiffness_N_per_m = 0,
                               .device_mass_kg = kMass_kg,
                               .device_damping_Ns_per_m = kFriction_Ns_per_m},
                              kTick_s);
  Passivity passivity({.control = control}, 8, 1 / kTick_s);
  passivity.reset(Vec3::Zero());
  HandDynamics::State state{Vec3::Zero(), Vec3(kStartSpeed_m_per_s, 0, 0)};
  Loop loop;
  constexpr int kTicks = 2000;
  loop.peaks_m.resize(10);
  for (int k = 0; k < kTicks; ++k) {
    const Vec3 before_W = state.position_W;
    const Vec3 added_W = passivity.damping(state.velocity_W);
    const Vec3 force_W = -kStiffness * before_W + added_W;
    passivity.hold(force_W);
    state = dynamics.step(state, Vec3::Zero(), Vec3::Zero(), force_W);
    passivity.moved(state.position_W);
    loop.least_J = std::min(loop.least_J, passivity.energy_J());
    loop.greatest_step_m = std::max(loop.greatest_step_m, (state.position_W - before_W).norm());
    loop.greatest_added_N = std::max(loop.greatest_added_N, added_W.norm());
    double& peak_m = loop.peaks_m[static_cast<std::size_t>(k * 10 / kTicks)];
    peak_m = std::max(peak_m, std::abs(state.position_W.x()));
  }
  return loop;
}

// More leak than friction: the oscillation grows at (leak - friction) / (2 m) = 2.5 /s. Over 1.8 s, from the first
// tenth of the run to the last, that is e^4.5 = 90; half of it is asked for, since the rate is one of first order.
TEST(PassivityController, WithoutItTheLoopIsActiveAndGrows) {
  const Loop loop = oscillate(false);
  EXPECT_GT(loop.peaks_m.back(),
            0.5 * std::exp((kLeak_Ns_per_m - kFriction_Ns_per_m) / (2 * kMass_kg) * 1.8) * loop.peaks_m.front());
  EXPECT_LT(loop.least_J, -0.5 * kStiffness * loop.peaks_m.back() * loop.peaks_m.back());
}

// For a spring, E = K x^2 / 2 - K / 2 sum (way of a tick)^2 + what the controller took. From one pass through the
// middle to the next the second term grows by at most K a^2 pi / (4 w T), a the longest way in a tick; so E falls below
// zero where K x^2 / 2 is no more than that, |x| <= a sqrt(pi / (2 w T)). A tick there takes at most K |x| a + K a^2 /
// 2, and the controller pays it back in the next. What then is left to the oscillation is the friction: it dies at b /
// (2 m).
TEST(PassivityController, WithItTheEnergyComesBackAndTheOscillationDies) {
  const Loop loop = oscillate(true);
  const double way_m = loop.greatest_step_m;
  const double bound_J = kStiffness * way_m * way_m * (std::sqrt(M_PI / (2 * kFrequency_rad_per_s * kTick_s)) + 0.5);
  EXPECT_LT(loop.least_J, 0);  // it had something to do
  EXPECT_GE(loop.least_J, -bound_J);
  for (std::size_t i = 1; i < loop.peaks_m.size(); ++i) EXPECT_LT(loop.peaks_m[i], loop.peaks_m[i - 1]);
  EXPECT_LT(loop.peaks_m.back(),
            kStartSpeed_m_per_s / kFrequency_rad_per_s * std::exp(-kFriction_Ns_per_m / (2 * kMass_kg) * 1.8));
  EXPECT_GT(loop.greatest_added_N, 0);
  EXPECT_LE(loop.greatest_added_N, 2);  // a quarter of 8 N
}

// A debt of `debt_J`: a push of 1 N over as many metres.
Passivity indebted(double debt_J, PassivityParameters parameters = {.control = true}) {
  Passivity passivity(parameters, 8, 1000);
  passivity.reset(Vec3::Zero());
  passivity.hold(Vec3(1, 0, 0));
  passivity.moved(Vec3(debt_J, 0, 0));
  return passivity;
}

TEST(PassivityController, TakesTheDebtBackInATick) {
  Passivity passivity = indebted(1e-6);
  const Vec3 velocity_W(0.03, 0, -0.04);
  const Vec3 force_W = passivity.damping(velocity_W);
  EXPECT_NEAR(force_W.dot(velocity_W) * 1e-3, -1e-6, 1e-18);
  EXPECT_TRUE(force_W.cross(velocity_W).isZero(1e-15));
}

// Whatever is owed, at whatever speed: against the motion, at most a quarter of 8 N, at most a damper of 10 N s/m.
TEST(PassivityController, ItsForceIsBoundedAndGivesNoBurstNearZeroVelocity) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> exponent(-12, 3), direction(-1, 1);
  for (int i = 0; i < 10000; ++i) {
    Passivity passivity = indebted(std::pow(10, exponent(random)));
    const Vec3 velocity_W =
        Vec3(direction(random), direction(random), direction(random)) * std::pow(10, exponent(random));
    const Vec3 force_W = passivity.damping(velocity_W);
    const double rounding = 1 + 8 * std::numeric_limits<double>::epsilon();
    ASSERT_TRUE(force_W.allFinite());
    ASSERT_LE(force_W.norm(), passivity.forceBound() * rounding);
    ASSERT_LE(force_W.norm(), 10 * velocity_W.norm() * rounding);
    ASSERT_LE(force_W.dot(velocity_W), 0);
  }
  EXPECT_TRUE(indebted(1).damping(Vec3::Zero()).isZero(0));
  EXPECT_TRUE(indebted(1).damping(Vec3(1e-320, 0, 0)).allFinite());
  EXPECT_DOUBLE_EQ(indebted(1).forceBound(), 2);
}

TEST(PassivityController, DoesNothingUnlessAskedOrWithoutDebt) {
  EXPECT_TRUE(indebted(1, {}).damping(Vec3(1, 0, 0)).isZero(0));
  EXPECT_TRUE(indebted(-1).damping(Vec3(1, 0, 0)).isZero(0));
}

// A tick's motion of `way_m` against a force of `force_N` along x.
void step(Passivity& passivity, double& x_m, double force_N, double way_m) {
  passivity.hold(Vec3(force_N, 0, 0));
  x_m += way_m;
  passivity.moved(Vec3(x_m, 0, 0));
}

// Bounds that never hold the controller back: 1000 N s/m and all of 1000 N.
Passivity unbounded(bool forget_credit) {
  Passivity passivity(
      {.control = true, .forget_credit = forget_credit, .force_share = 1, .damping_limit_Ns_per_m = 1000}, 1000, 1000);
  passivity.reset(Vec3::Zero());
  return passivity;
}

// A contact that took 1 J, a tick without force, then one that gave 0.1 J: a debt of 0.1 J, which a damper takes back
// in a tick with 0.1 J / (1 ms (1 m/s)^2) = 100 N s/m; or none, if the credit is kept.
TEST(PassivityController, CreditIsForgottenInFreeMotion) {
  for (const bool forget : {true, false}) {
    Passivity passivity = unbounded(forget);
    double x_m = 0;
    step(passivity, x_m, 2, -0.5);
    step(passivity, x_m, 0, -0.1);
    step(passivity, x_m, 1, 0.1);
    EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0)).x(), forget ? -100 : 0, 1e-9);
    EXPECT_NEAR(passivity.energy_J(), 0.9, 1e-12);  // the observer forgets nothing
  }
}

// Credit is kept as long as a force is held, were it as small as can be: the spring is still bent.
TEST(PassivityController, CreditIsKeptWhileThereIsAForce) {
  Passivity passivity = unbounded(true);
  double x_m = 0;
  step(passivity, x_m, 2, -0.5);
  step(passivity, x_m, 1e-300, -0.1);
  step(passivity, x_m, 1, 0.1);
  EXPECT_TRUE(passivity.damping(Vec3(1, 0, 0)).isZero(0));
}

// What the springs hold is no credit, whatever the contact took: 1 J went into a spring that holds 0.4 J now, so 0.6 J
// were dissipated. Of 0.5 J that come out, 0.1 J were never stored.
TEST(PassivityController, OnlyWhatIsStoredMayComeOut) {
  for (const bool forget : {true, false}) {
    Passivity passivity = unbounded(forget);
    double x_m = 0;
    step(passivity, x_m, 2, -0.5);
    EXPECT_TRUE(passivity.damping(Vec3(1, 0, 0), {0.4, 2}).isZero(0));
    step(passivity, x_m, 1, 0.5);
    EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0), {0, 0}).x(), forget ? -100 : 0, 1e-9);
    step(passivity, x_m, -0.1, 1);  // pays it back
    EXPECT_TRUE(passivity.damping(Vec3(1, 0, 0), {0, 0}).isZero(1e-9));
  }
}

// A spring that gains energy of its own accord, as when a surface moves against the tool, owes it at once.
TEST(PassivityController, WhatIsStoredWithoutWorkIsOwed) {
  Passivity passivity = unbounded(true);
  double x_m = 0;
  step(passivity, x_m, 2, -0.5);
  EXPECT_TRUE(passivity.damping(Vec3(1, 0, 0), {1, 2}).isZero(0));
  EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0), {1.1, 2}).x(), -100, 1e-9);
}

// A spring of 1000 N/m, pressed slowly and let go slowly; from 8 mm on its force is cut to 8 N. In steps of 1 um its
// work differs from the integral by K / 2 times the step, times the way: 20 mm * 0.5 mN.
TEST(PassivityController, ACutForceStoresLess) {
  Passivity passivity = unbounded(true);
  constexpr double kLimit_N = 8, kSpring_N_per_m = 1000, kWay_m = 1e-6;
  double x_m = 0, most_N = 0;
  const auto wanted_N = [&] { return -kSpring_N_per_m * x_m; };
  for (int i = 0; i < 40000; ++i) {
    const Vec3 damping_W = passivity.damping(Vec3(1, 0, 0), {0.5 * kSpring_N_per_m * x_m * x_m, wanted_N()}, kLimit_N);
    most_N = std::max(most_N, damping_W.norm());
    step(passivity, x_m, std::min(wanted_N(), kLimit_N), i < 20000 ? -kWay_m : kWay_m);
  }
  EXPECT_LE(most_N / 1000, 20e-3 * 0.5e-3);  // 1 N takes a thousandth of a joule in this tick
}

// With 0.9 J on the observer's side, 0.1 J is owed; free motion forgives none of it, and what is paid back is no longer
// owed.
TEST(PassivityController, DebtStaysInFreeMotionUntilItIsPaid) {
  Passivity passivity = unbounded(true);
  double x_m = 0;
  step(passivity, x_m, 2, -0.5);
  step(passivity, x_m, 0, 0.1);
  step(passivity, x_m, 1, 0.1);
  for (int i = 0; i < 3; ++i) step(passivity, x_m, 0, 0.1);
  EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0)).x(), -100, 1e-9);
  step(passivity, x_m, -0.6, 0.1);
  EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0)).x(), -40, 1e-9);
  step(passivity, x_m, -0.4, 0.1);
  EXPECT_NEAR(passivity.damping(Vec3(1, 0, 0)).x(), 0, 1e-9);
  EXPECT_NEAR(passivity.energy_J(), 1, 1e-12);
}

// Each of the three bounds, where it is the smallest: what is owed, 1 N s/m, a quarter of 8 N.
TEST(PassivityController, TheSmallestBoundCounts) {
  Passivity passivity({.control = true, .damping_limit_Ns_per_m = 1}, 8, 1000);
  passivity.reset(Vec3::Zero());
  double x_m = 0;
  step(passivity, x_m, 1, 1e-3);
  EXPECT_NEAR(passivity.damping(Vec3(1.5, 0, 0)).x(), -1e-3 * 1000 / 1.5, 1e-12);
  EXPECT_NEAR(passivity.damping(Vec3(-0.5, 0, 0)).x(), 0.5, 1e-12);
  step(passivity, x_m, 1, 0.1);
  EXPECT_NEAR(passivity.damping(Vec3(5, 0, 0)).x(), -2, 1e-12);
}

TEST(PassivityController, RefusesBoundsThatAreNone) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](PassivityParameters p) { EXPECT_THROW(Passivity(p, 8, 1000), Error); };
  refused({.force_share = -0.1});
  refused({.force_share = 1.1});
  refused({.force_share = kNaN});
  refused({.damping_limit_Ns_per_m = -1});
  refused({.damping_limit_Ns_per_m = kNaN});
  EXPECT_THROW(Passivity({}, 8, 1000, -1), Error);
  EXPECT_THROW(Passivity({}, 8, 1000, 0, -1e-6), Error);
  EXPECT_THROW(Passivity({}, 8, 1000, 0, kNaN), Error);
  EXPECT_EQ(Passivity({.force_share = 0, .damping_limit_Ns_per_m = 0}, 8, 1000).forceBound(), 0);
  EXPECT_EQ(Passivity({.force_share = 1}, 8, 1000).forceBound(), 8);
}

}  // namespace passivity_test
}  // namespace palpate
