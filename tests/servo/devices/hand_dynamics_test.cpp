// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hand_dynamics.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace hand_dynamics_test {

// Free oscillation about `rest`: x = rest + e^(-s t) (A cos w t + B sin w t), s = b / 2m, w^2 = k / m - s^2.
struct Oscillator {
  double stiffness, damping, mass, rest, position, velocity;
  [[nodiscard]] double at(double t) const {
    const double s = damping / (2 * mass);
    const double w = std::sqrt(stiffness / mass - s * s);
    const double a = position - rest;
    const double b = (velocity + s * a) / w;
    return rest + std::exp(-s * t) * (a * std::cos(w * t) + b * std::sin(w * t));
  }
};

// A constant force on a hand that holds still: a damped oscillator about F / k. The only error is rounding: 1000 ticks
// of a contraction, some 1e-16 each of values near 0.01.
TEST(HandDynamics, MeetsTheDampedOscillatorExactly) {
  const HandParameters p;
  const double mass = p.hand_mass_kg + p.device_mass_kg;
  const double damping = p.hand_damping_Ns_per_m + p.device_damping_Ns_per_m;
  for (const double tick_s : {1e-3, 1e-2}) {
    const HandDynamics dynamics(p, tick_s);
    const Vec3 force_W(2, -1, 0);
    HandDynamics::State state{{0.01, 0, -0.004}, {0.1, 0.2, 0}};
    const auto axis = [&](int i) {
      return Oscillator{
          p.hand_stiffness_N_per_m, damping, mass, force_W[i] / p.hand_stiffness_N_per_m, state.position_W[i],
          state.velocity_W[i]};
    };
    const Oscillator exact[3] = {axis(0), axis(1), axis(2)};
    for (int tick = 1; tick <= 1000; ++tick) {
      state = dynamics.step(state, Vec3::Zero(), Vec3::Zero(), force_W);
      for (int i = 0; i < 3; ++i) ASSERT_NEAR(state.position_W[i], exact[i].at(tick * tick_s), 1e-14);
    }
  }
}

// A path that runs straight on: the solution is r(t) plus the oscillator about a lag of b_device v / k.
TEST(HandDynamics, MeetsTheRampExactly) {
  const HandParameters p;
  const HandDynamics dynamics(p, 1e-3);
  const double speed = 0.3;
  const double lag = p.device_damping_Ns_per_m * speed / p.hand_stiffness_N_per_m;
  const Oscillator exact{p.hand_stiffness_N_per_m,
                         p.hand_damping_Ns_per_m + p.device_damping_Ns_per_m,
                         p.hand_mass_kg + p.device_mass_kg,
                         -lag,
                         0,
                         -speed};
  HandDynamics::State state;
  for (int tick = 0; tick < 500; ++tick) {
    const Vec3 start_W(speed * tick * 1e-3, 0, 0);
    const Vec3 end_W(speed * (tick + 1) * 1e-3, 0, 0);
    state = dynamics.step(state, start_W, end_W, Vec3::Zero());
    ASSERT_NEAR(state.position_W.x(), end_W.x() + exact.at((tick + 1) * 1e-3), 1e-13);
  }
}

// Exact steps do not depend on their size.
TEST(HandDynamics, TwoHalfTicksAreOneTick) {
  const HandDynamics whole({}, 1e-3);
  const HandDynamics half({}, 0.5e-3);
  const Vec3 a(0.01, 0, 0), b(0.012, -0.001, 0.003), force_W(1, 2, -3);
  const HandDynamics::State start{{0.005, 0.001, 0}, {0.3, 0, -0.2}};
  const auto one = whole.step(start, a, b, force_W);
  const auto two = half.step(half.step(start, a, 0.5 * (a + b), force_W), 0.5 * (a + b), b, force_W);
  EXPECT_LT((one.position_W - two.position_W).norm(), 1e-16);
  EXPECT_LT((one.velocity_W - two.velocity_W).norm(), 1e-14);
}

// A device without hand or friction is a free mass: x = F t^2 / 2m.
TEST(HandDynamics, AFreeMass) {
  const HandDynamics dynamics({0, 0, 0, 0.05, 0}, 1e-3);
  HandDynamics::State state;
  for (int i = 0; i < 100; ++i) state = dynamics.step(state, Vec3::Zero(), Vec3::Zero(), Vec3(1, 0, 0));
  EXPECT_NEAR(state.position_W.x(), 0.5 * 1 / 0.05 * 0.01, 1e-13);
  EXPECT_NEAR(state.velocity_W.x(), 1 / 0.05 * 0.1, 1e-13);
}

// ---- dry friction ----

// A free mass that slides comes to rest after v m / f_c, v^2 m / 2 f_c farther, and stays there: within one tick, or
// cut into many.
TEST(HandFriction, StopsASlidingMassWhereItMust) {
  constexpr double kMass = 0.05, kFriction = 0.4, kSpeed = 0.2;
  const double stop_m = kSpeed * kSpeed * kMass / (2 * kFriction);  // after 25 ms
  for (const double tick_s : {1e-4, 1e-3, 10e-3, 0.1}) {
    const HandDynamics dynamics({0, 0, 0, kMass, 0, kFriction}, tick_s);
    HandDynamics::State state{{0.01, 0, 0}, {-kSpeed, 0, kSpeed}};
    for (double t = 0; t < 0.2; t += tick_s) state = dynamics.step(state, Vec3::Zero(), Vec3::Zero(), Vec3::Zero());
    EXPECT_NEAR(state.position_W.x(), 0.01 - stop_m, 1e-15) << tick_s;
    EXPECT_NEAR(state.position_W.z(), stop_m, 1e-15) << tick_s;
    EXPECT_EQ(state.velocity_W, Vec3(0, 0, 0)) << tick_s;
  }
}

// At rest nothing moves it that is weaker, and what is stronger moves it with the rest: x = (F - f_c) t^2 / 2 m.
TEST(HandFriction, HoldsAgainstWhatIsWeaker) {
  const HandDynamics dynamics({0, 0, 0, 0.05, 0, 0.4}, 1e-3);
  HandDynamics::State state;
  for (int i = 0; i < 100; ++i) state = dynamics.step(state, Vec3::Zero(), Vec3::Zero(), Vec3(0.4, -0.39, 0.5));
  EXPECT_EQ(state.position_W.x(), 0);
  EXPECT_EQ(state.position_W.y(), 0);
  EXPECT_NEAR(state.position_W.z(), 0.5 * 0.1 / 0.05 * 0.01, 1e-14);
}

// The hand pulls by a spring whose end goes at v: the device breaks loose when k v t = f_c, in the middle of a tick.
TEST(HandFriction, BreaksLooseInTheMiddleOfATick) {
  constexpr double kStiffness = 400, kSpeed = 0.1, kFriction = 0.21;
  const double loose_s = kFriction / (kStiffness * kSpeed);  // 5.25 ms
  const HandDynamics dynamics({0.1, 0, kStiffness, 0, 0, kFriction}, 1e-3);
  HandDynamics::State state;
  for (int tick = 0; tick < 8; ++tick) {
    const Vec3 start(kSpeed * 1e-3 * tick, 0, 0), end(kSpeed * 1e-3 * (tick + 1), 0, 0);
    state = dynamics.step(state, start, end, Vec3::Zero());
    if ((tick + 1) * 1e-3 < loose_s) {
      EXPECT_EQ(state.position_W.x(), 0);
    } else {  // from then on m x'' = k v t' - k x with t' since it broke loose: x = v (t' - sin(w t') / w)
      const double w = std::sqrt(kStiffness / 0.1), t = (tick + 1) * 1e-3 - loose_s;
      EXPECT_NEAR(state.position_W.x(), kSpeed * (t - std::sin(w * t) / w), 1e-15) << tick;
    }
  }
}

// Against small steps of the plain law, with everything at once; the small steps' own error is of first order.
TEST(HandFriction, AgreesWithSmallSteps) {
  const HandParameters p{0.1, 3, 400, 0.05, 0.1, 0.3};
  const HandDynamics dynamics(p, 1e-3);
  HandDynamics::State state;
  double x = 0, v = 0;
  constexpr int kParts = 20'000;
  const auto path = [](double t) { return 0.01 * std::sin(30 * t); };
  for (int tick = 0; tick < 150; ++tick) {
    const double start = path(1e-3 * tick), end = path(1e-3 * (tick + 1)), slope = (end - start) / 1e-3;
    const double force = 0.5 * std::sin(0.2 * tick);
    state = dynamics.step(state, Vec3(start, 0, 0), Vec3(end, 0, 0), Vec3(force, 0, 0));
    for (int i = 0; i < kParts; ++i) {
      constexpr double kStep = 1e-3 / kParts;
      const double pull = 400 * (start + slope * kStep * i - x) + 3 * (slope - v) - 0.1 * v + force;
      if (v == 0 && std::abs(pull) <= 0.3) continue;
      const double sign = v != 0 ? std::copysign(1.0, v) : std::copysign(1.0, pull);
      const double next = v + kStep * (pull - 0.3 * sign) / 0.15;
      v = v != 0 && next * v < 0 ? 0 : next;
      x += kStep * v;
    }
    ASSERT_NEAR(state.position_W.x(), x, 2e-8) << tick;
  }
}

// The same without friction, or with hardly any.
TEST(HandFriction, GoesOverIntoNone) {
  HandParameters p;
  const HandDynamics none(p, 1e-3);
  p.device_friction_N = 1e-15;
  const HandDynamics hardly(p, 1e-3);
  const HandDynamics::State start{{0.005, 0.001, 0}, {0.3, 0.1, -0.2}};
  const Vec3 a(0.01, 0, 0), b(0.012, -0.001, 0.003), force_W(1, 2, -3);
  EXPECT_LT((none.step(start, a, b, force_W).position_W - hardly.step(start, a, b, force_W).position_W).norm(), 1e-15);
  EXPECT_LT((none.step(start, a, b, force_W).velocity_W - hardly.step(start, a, b, force_W).velocity_W).norm(), 1e-13);
}

TEST(HandDynamics, RefusesWhatCannotMove) {
  EXPECT_THROW(HandDynamics({0.1, 3, 400, 0.05, 0.1, -0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0.1, 3, 400, 0.05, 0.1, NAN}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0, 3, 400, 0, 0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({-0.1, 3, 400, 0.5, 0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0.1, -3, 400, 0.05, 0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0.1, 3, NAN, 0.05, 0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0.1, 3, 400, -0.05, 0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({0.1, 3, 400, 0.05, -0.1}, 1e-3), Error);
  EXPECT_THROW(HandDynamics({}, 0), Error);
}

// A device may have no mass, nor friction, if the hand has a mass.
TEST(HandDynamics, TakesTheEndsOfTheRanges) {
  EXPECT_NO_THROW(HandDynamics({0.1, 0, 0, 0, 0}, 1e-3));
}

// 150 g that are braked within a tick, three ticks, and those and 1 / (2 pi 200 Hz).
TEST(HandDynamics, ADampingBrakesUpToTheMassOverTheForcesDelay) {
  const HandParameters p{.hand_mass_kg = 0.1, .device_mass_kg = 0.05};
  EXPECT_DOUBLE_EQ(brakingDamping(p, 1000, 0, 0), 150);
  EXPECT_DOUBLE_EQ(brakingDamping(p, 1000, 2, 0), 50);
  EXPECT_NEAR(brakingDamping(p, 1000, 2, 200), 0.15 / (3e-3 + 0.795775e-3), 1e-4);
}

TEST(HandDynamics, AForceMayJumpByTwiceTheDryFriction) {
  EXPECT_DOUBLE_EQ(quietJump({.device_friction_N = 0.3}), 0.6);
  EXPECT_DOUBLE_EQ(quietJump({.device_friction_N = 0.001}), 0.04);
}

}  // namespace hand_dynamics_test
}  // namespace palpate
