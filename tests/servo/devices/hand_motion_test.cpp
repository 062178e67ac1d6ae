// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hand_motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "support/seeded.hpp"

namespace palpate {
namespace hand_motion_test {

constexpr double kTick_s = 1e-3, kResolution_m = 5e-5;

// A law that has seen a hand at rest, or at this speed, for 30 ms.
MotionLaw after(double speed_m_per_s, double waited_s) {
  MotionLaw law(kHandMotion, kResolution_m);
  for (int i = 0; i < 30; ++i) law.believe(speed_m_per_s * kTick_s, kTick_s, waited_s);
  return law;
}

// (v + a (T + T) / 2) T from rest: 1 mm where the time is known, and (1.5 ms a) 2 ms = 3 mm where it is known to a
// report. Four resolutions of 0.05 mm come on top, and as much within v.
TEST(MotionLaw, ASlipFromRestIsNoMotion) {
  const double rounding_m = 4 * kResolution_m;
  EXPECT_NEAR(after(0, 0).longestWay_m(kTick_s, 0), 1e-3 + 2 * rounding_m, 1e-12);
  EXPECT_NEAR(after(0, kTick_s).longestWay_m(kTick_s, kTick_s), 3e-3 + 3 * rounding_m, 1e-12);
  for (const double slip_m : {0.012, 0.015, 0.018})
    EXPECT_LT(after(2, kTick_s).longestWay_m(kTick_s, kTick_s), slip_m) << "also at 2 m/s";
  // Nothing is known: then speed alone counts.
  EXPECT_NEAR(MotionLaw(kHandMotion, 0).longestWay_m(kTick_s, 0), 0.01, 1e-12);
}

// One that always takes what it is given: never more than 10 m/s over the time since it began, and what one report may
// have waited. The rounding is given each time.
TEST(MotionLaw, NoHandIsFasterThanTheFastestForLong) {
  Seeded random(5);
  for (int run = 0; run < 100; ++run) {
    MotionLaw law(kHandMotion, 0);
    double way_m = 0, time_s = 0, waited_s = 0;
    for (int i = 0; i < 500; ++i) {
      const double next_s = random.between(2e-4, 3e-3);
      const double step_m = law.longestWay_m(next_s, waited_s);
      law.believe(step_m, next_s, waited_s);
      way_m += step_m;
      time_s += next_s;
      waited_s = 1e-3;
      ASSERT_LE(way_m, 10 * (time_s + waited_s) * (1 + 1e-9)) << i;
    }
    EXPECT_GE(way_m, 9.9 * time_s);
  }
}

// From rest no faster than the acceleration allows: in the nth report a n T. Each one's rounding is counted twice.
TEST(MotionLaw, NoHandIsAcceleratedMore) {
  MotionLaw law = after(0, 0);
  for (int i = 1; i <= 6; ++i) {
    const double step_m = law.longestWay_m(kTick_s, 0);
    ASSERT_NEAR(step_m / kTick_s, i * (1000 * kTick_s + 2 * 4 * kResolution_m / kTick_s), 1e-9) << i;
    law.believe(step_m, kTick_s, 0);
  }
}

// A hand that strokes and taps: random accelerations of up to 400 m/s^2, three times those of the fastest strokes over
// a workspace (4 x 0.1 m / (50 ms)^2), up to 9 m/s, and walls that stop or throw it back. Its device is asked anew when
// an answer has come, and was where it says at any time between; answers take 0.3 to 3 ms, and now and then 50.
TEST(MotionLaw, StrokesAndTapsAreMotion) {
  double fastest_m_per_s = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Seeded random(seed);
    MotionLaw law(kHandMotion, kResolution_m);
    constexpr double kStep_s = 2e-5;
    Vec3 at = Vec3::Zero(), velocity = Vec3::Zero(), acceleration = Vec3::Zero();
    const auto pass = [&](double time_s) {
      for (double t = 0; t < time_s; t += kStep_s) {
        if (random.pick(1500) == 0) acceleration = random.between(0, 400) * random.direction();
        if (random.pick(4000) == 0) velocity = -random.between(0, 1) * velocity;  // a wall
        Vec3 next = velocity + kStep_s * acceleration;
        if (next.norm() > 9) {
          acceleration.setZero();
          next = velocity;
        }
        at += 0.5 * kStep_s * (velocity + next);
        velocity = next;
      }
    };
    const auto read = [&] {
      Vec3 reading = at;
      for (double& x : reading) x = std::round(x / kResolution_m) * kResolution_m;
      return reading;
    };
    Vec3 last = read();
    double waited_s = 0;
    for (int report = 0; report < 800; ++report) {
      const double takes_s = random.pick(200) == 0 ? 0.05 : random.between(3e-4, 3e-3);
      const double is_asked_s = takes_s * random.between(0, 1);
      pass(is_asked_s);
      const Vec3 reading = read();
      pass(takes_s - is_asked_s);
      const double way_m = (reading - last).norm();
      ASSERT_LE(way_m, law.longestWay_m(takes_s, waited_s)) << report;
      law.believe(way_m, takes_s, waited_s);
      last = reading;
      waited_s = takes_s;
      fastest_m_per_s = std::max(fastest_m_per_s, velocity.norm());
    }
  }
  EXPECT_GT(fastest_m_per_s, 7);
}

// The usual bounds: a path may have any acceleration.
TEST(MotionLaw, APathMayBeginAtOnce) {
  MotionLaw law(MotionBounds{}, 0);
  for (int i = 0; i < 100; ++i) law.believe(0, kTick_s, 0);
  EXPECT_NEAR(law.longestWay_m(kTick_s, 0), 1, 1e-12);
}

}  // namespace hand_motion_test
}  // namespace palpate
