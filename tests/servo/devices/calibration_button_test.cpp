// SPDX-License-Identifier: Apache-2.0
// A calibration that is asked for where it must not be: by the button in contact, in motion, away from home, by lines
// that chatter. Each case has a twin, an equal arm whose button nobody presses: as long as it is refused, both are the
// same.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "servo/devices/polhem_device.hpp"
#include "support/emulated_polhem.hpp"
#include "support/polhem_bench.hpp"
#include "support/seeded.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace calibration_button_test {

Vec3 within(Seeded& numbers, double radius_m) {
  return numbers.between(0, radius_m) * numbers.direction();
}

Vec3 homeOf(const PolhemParameters& p) {
  const ArmKinematics arm(p.joints, p.origin_m);
  const Vec3 home_A = arm.position(arm.angles({p.home_counts[0], p.home_counts[1], p.home_counts[2]}));
  return {home_A.y(), home_A.z(), home_A.x()};
}

// What the button's line says, tick by tick, from the first tick of the press on.
class Line {
 public:
  enum class Kind { kLatched, kHeld, kChattering, kGlitches };
  Line(Kind kind, Seeded& numbers) : kind_(kind) {
    chatter_ticks_ = static_cast<int>(numbers.between(1, 21));
    held_ticks_ = static_cast<int>(numbers.between(40, 400));
    for (int i = 0; i < 32; ++i) bounces_.push_back(numbers.pick(2) == 0);
  }
  // Latched: the firmware holds it. The others' line is what the contacts say.
  void apply(EmulatedPolhem& arm, int tick) const {
    if (kind_ == Kind::kLatched) {
      if (tick == 0) arm.pressCalibration();
      return;
    }
    const bool bounces = kind_ != Kind::kHeld && tick < chatter_ticks_;
    const int bounce = kind_ == Kind::kGlitches ? tick % kGlitch_ticks : 0;
    bool line = kind_ != Kind::kGlitches && tick < chatter_ticks_ + held_ticks_;
    if (bounces) line = bounces_[static_cast<std::size_t>(tick)] && bounce < kGlitch_ticks - 1;
    line ? arm.pressCalibration() : arm.releaseCalibration();
  }

 private:
  static constexpr int kGlitch_ticks = 9;  // less than 10 ms of them in a row
  Kind kind_;
  int chatter_ticks_, held_ticks_;
  std::vector<bool> bounces_;
};

Line::Kind anyKind(Seeded& numbers) {
  return static_cast<Line::Kind>(numbers.pick(4));
}

// A wall through `at`, which pushes along `normal`.
struct Wall {
  Vec3 at = Vec3::Zero(), normal = Vec3::Zero();
  double stiffness_N_per_m = 0;
  [[nodiscard]] Vec3 force(const Vec3& p) const {
    const double depth_m = (at - p).dot(normal);
    return depth_m > 0 ? Vec3(stiffness_N_per_m * depth_m * normal) : Vec3(Vec3::Zero());
  }
};

void pass(PolhemBench& bench, const Wall& wall) {
  Vec3 at = Vec3::Zero();
  ASSERT_TRUE(bench.device.read(at));
  static_cast<void>(bench.device.write(wall.force(at)));
  bench.device.elapse(1);
}

int cases() {
  return isLongRun() ? 10'000 : 1'000;
}

// A press in contact: not one force of the wall becomes another one, and the arm counts as before.
TEST(CalibrationButton, ChangesNothingInContact) {
  Seeded numbers(11);
  for (int i = 0; i < cases(); ++i) {
    SCOPED_TRACE(i);
    const Vec3 target = within(numbers, 0.08);
    const SampledPath path({0}, {target}, SampledPath::Interpolation::kLinear);
    Wall wall{.normal = numbers.direction(), .stiffness_N_per_m = numbers.between(100, 800)};
    // The hand's spring of 400 N/m and the wall's share the way; 1 to 4.5 N at rest.
    const double force_N = numbers.between(1, 4.5);
    wall.at = target + force_N * (1 / 400.0 + 1 / wall.stiffness_N_per_m) * wall.normal;
    PolhemBench pressed(path), twin(path);
    const Line line(anyKind(numbers), numbers);
    const int begin = static_cast<int>(numbers.between(120, 240));
    for (int tick = 0; tick < begin + 150; ++tick) {
      if (tick >= begin) line.apply(pressed.emulated, tick - begin);
      pass(pressed, wall);
      pass(twin, wall);
      ASSERT_EQ(pressed.emulated.currents_A(), twin.emulated.currents_A()) << tick;
    }
    ASSERT_EQ(pressed.device.counts(), twin.device.counts());
    ASSERT_EQ(pressed.figure("calibrations"), 0);
    ASSERT_LE(pressed.figure("calibrations_refused_in_contact"), 1);
    ASSERT_EQ(pressed.device.forceOff(), ForceOff::kNone);
  }
}

// A press while the handle moves, or where it rests away from home: the arm stays as it was, calibrated or not. The
// request is forgotten once the handle rests; the counts that it had within a report may shift.
TEST(CalibrationButton, ChangesNothingInMotionOrAwayFromHome) {
  Seeded numbers(12);
  int refused = 0;
  for (int i = 0; i < cases(); ++i) {
    SCOPED_TRACE(i);
    const bool calibrated = numbers.pick(2) == 0, moves = !calibrated || numbers.pick(2) == 0;
    const Vec3 from = within(numbers, 0.08);
    Vec3 to = from;
    double speed = 0;
    if (moves) {
      speed = numbers.between(0.03, 1);
      to = within(numbers, 0.08);
      while ((to - from).norm() < 0.04) to = within(numbers, 0.08);
    }
    // It moves from 150 ms on; the button is pressed in the middle of the way.
    const double way_s = moves ? (to - from).norm() / speed : 0.05;
    const SampledPath path({0, 0.15, 0.15 + way_s}, {from, from, to}, SampledPath::Interpolation::kLinear);
    HandParameters hand;
    hand.hand_stiffness_N_per_m = 1e5;
    hand.hand_damping_Ns_per_m = 200;
    PolhemBench pressed(path, knownPolhem(), calibrated, hand), twin(path, knownPolhem(), calibrated, hand);
    const Line line(anyKind(numbers), numbers);
    const int begin = 150 + static_cast<int>(1e3 * way_s / 2), end = 150 + static_cast<int>(1e3 * way_s) + 700;
    const bool in_time = way_s / 2 > 0.04;  // the press is sure before the handle rests
    for (int tick = 0; tick < end; ++tick) {
      if (tick >= begin) line.apply(pressed.emulated, tick - begin);
      pass(pressed, {});
      pass(twin, {});
      for (std::size_t k = 0; k < 3; ++k)
        ASSERT_LE(std::abs(pressed.device.counts()[k] - twin.device.counts()[k]), 1) << tick;
    }
    ASSERT_EQ(pressed.device.forceOff(), twin.device.forceOff());
    ASSERT_EQ(pressed.figure("calibrations"), 0);
    ASSERT_EQ(pressed.figure("reports_implausible"), 0);
    const double moving = pressed.figure("calibrations_refused_moving"),
                 away = pressed.figure("calibrations_refused_away");
    ASSERT_LE(moving + away, 1);
    ASSERT_TRUE(!in_time || !moves || away == 0);
    refused += static_cast<int>(moving + away);
    // Free again: what was asked is forgotten.
    ASSERT_FALSE(parsePolhem(pressed.emulated.state().content(), 14)->asks_for_calibration);
  }
  EXPECT_GT(refused, cases() / 2);
}

// At home and at rest: a press counts once, however its line chatters; glitches are no press.
TEST(CalibrationButton, CountsOnceAtHome) {
  Seeded numbers(13);
  const PolhemParameters p = knownPolhem();
  for (int i = 0; i < cases() / 4; ++i) {
    SCOPED_TRACE(i);
    const SampledPath path({0}, {homeOf(p) + within(numbers, 3e-3)}, SampledPath::Interpolation::kLinear);
    PolhemBench bench(path, p, numbers.pick(2) == 0);
    const Line::Kind kind = anyKind(numbers);
    const Line line(kind, numbers);
    const bool was_calibrated = bench.device.forceOff() == ForceOff::kNone;
    for (int tick = 0; tick < 900; ++tick) {
      if (tick >= 150) line.apply(bench.emulated, tick - 150);
      pass(bench, {});
    }
    const bool counts = kind != Line::Kind::kGlitches;
    ASSERT_EQ(bench.figure("calibrations"), counts ? 1 : 0) << static_cast<int>(kind);
    ASSERT_EQ(bench.device.forceOff(), counts || was_calibrated ? ForceOff::kNone : ForceOff::kUncalibrated);
  }
}

// After a refusal the button works where it may: the user lets the wall go, comes home, and presses again.
TEST(CalibrationButton, WorksAfterARefusal) {
  const PolhemParameters p = knownPolhem();
  const Vec3 home = homeOf(p);
  const SampledPath path({0, 0.5, 1}, {Vec3(0, 0, 0), Vec3(0, 0, 0), home}, SampledPath::Interpolation::kLinear);
  PolhemBench bench(path, p);
  const Wall wall{.at = Vec3(0, 0.005, 0), .normal = Vec3(0, 1, 0), .stiffness_N_per_m = 500};
  for (int tick = 0; tick < 200; ++tick) pass(bench, wall);
  EXPECT_GT(bench.emulated.force_D().y(), 0.5);
  bench.emulated.pressCalibration();
  for (int tick = 0; tick < 200; ++tick) pass(bench, wall);
  EXPECT_EQ(bench.figure("calibrations_refused_in_contact"), 1);
  EXPECT_GT(bench.emulated.force_D().y(), 0.5);
  for (int tick = 0; tick < 1200; ++tick) pass(bench, {});
  EXPECT_EQ(bench.figure("calibrations"), 0);
  bench.emulated.pressCalibration();
  for (int tick = 0; tick < 100; ++tick) pass(bench, {});
  EXPECT_EQ(bench.figure("calibrations"), 1);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
  EXPECT_LT((bench.position() - home).norm(), 5e-3);
}

// Asked by a program: the same, and it says why.
TEST(CalibrationButton, IsRefusedToProgramsAlike) {
  const SampledPath moving({0, 1}, {Vec3(-0.05, 0, 0), Vec3(0.05, 0, 0)}, SampledPath::Interpolation::kLinear);
  PolhemBench moves(moving, knownPolhem(), false), pushes(resting()), rests(resting()),
      unknown(resting(), knownPolhem(), false);
  moves.pass(300);
  pushes.pass(300, Vec3(0, 0.1, 0));
  rests.pass(300);
  unknown.pass(300);
  EXPECT_EQ(moves.device.calibrate(), CalibrationRefusal::kMoving);
  EXPECT_EQ(pushes.device.calibrate(), CalibrationRefusal::kContact);
  EXPECT_EQ(rests.device.calibrate(), CalibrationRefusal::kAway);
  EXPECT_EQ(rests.device.forceOff(), ForceOff::kNone);
  EXPECT_EQ(unknown.device.calibrate(), CalibrationRefusal::kNone);
  for (const CalibrationRefusal why : kCalibrationRefusals) EXPECT_FALSE(wordsOf(why).remedy.empty());
}

}  // namespace calibration_button_test
}  // namespace palpate
