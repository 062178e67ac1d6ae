// SPDX-License-Identifier: Apache-2.0
// The host's side of a Polhem against the emulated other end of its cable, by the simulated clock.
#include "servo/devices/polhem_device.hpp"

#include <atomic>
#include <chrono>
#include <cmath>
#include <semaphore>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/devices/placed_device.hpp"
#include "servo/devices/simulated_device.hpp"
#include "support/emulated_polhem.hpp"

namespace palpate {
namespace polhem_device_test {

constexpr double kTick_s = 1e-3;

PolhemParameters known() {
  PolhemParameters p;
  p.current_limit_A = 3;
  return p;
}

// From 2 cm above to 1 cm below the middle of the workspace, then sideways.
const SampledPath& press() {
  static const SampledPath path({0, 1, 2, 3},
                                {Vec3(0, 0.02, 0), Vec3(0, -0.01, 0), Vec3(0.03, -0.01, 0.02), Vec3(0, 0.02, 0)},
                                SampledPath::Interpolation::kCubic);
  return path;
}
const SampledPath& rest() {
  static const SampledPath path({0}, {Vec3(0.01, 0.02, -0.01)}, SampledPath::Interpolation::kLinear);
  return path;
}

Vec3 wall(const Vec3& position, double stiffness) {
  return position.y() < 0 ? Vec3(0, -stiffness * position.y(), 0) : Vec3(Vec3::Zero());
}

// A device on an emulated cable.
struct Bench {
  explicit Bench(const Path& path, const PolhemParameters& p = known(), bool calibrated = true,
                 const HandParameters& hand = {})
      : emulated(p, hand, path, kTick_s, calibrated),
        cable(emulated),
        device(p, {.simulated_clock = true, .rate_hz = 1 / kTick_s, .calibrated = calibrated, .answer_ms = 0},
               cable.opener()) {}

  Vec3 position() {
    Vec3 p = Vec3::Constant(std::nan(""));
    EXPECT_TRUE(device.read(p));
    return p;
  }
  double figure(std::string_view key) const {
    for (const DeviceFigure& f : device.figures()) {
      if (f.key == key) return f.value;
    }
    ADD_FAILURE() << "no figure " << key;
    return -1;
  }
  // Ticks with the same force.
  void pass(int ticks, const Vec3& force = Vec3::Zero()) {
    Vec3 ignored;
    for (int i = 0; i < ticks; ++i) {
      static_cast<void>(device.write(force));
      device.elapse(1);
      static_cast<void>(device.read(ignored));
    }
  }

  EmulatedPolhem emulated;
  EmulatedCable cable;
  PolhemDevice device;
};

// Half a count of each encoder moves the handle by half a column of the Jacobian, 0.5 (0.18 + 0.18 + 0.14) / 2 pi /
// 20000 ... in all less than one resolution; the wall turns that into a force, and the hand's spring of 400 N/m yields
// to it by K / 400 as much. A current's half milliampere is 0.03 N / 400 N/m at most of that size again.
TEST(PolhemDevice, FeelsAWallAsTheSimulatedDeviceDoes) {
  constexpr double kStiffness = 600;
  Bench bench(press());
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  p.force_limit_N = 5;
  SimulatedDevice exact(p, press(), 1 / kTick_s);
  const double resolution_m = bench.device.limits().position_resolution_m;
  const double bound_m = 2 * resolution_m * (1 + kStiffness / p.dynamics.hand_stiffness_N_per_m);
  double deepest_m = 0, worst_m = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    Vec3 exact_at;
    static_cast<void>(exact.read(exact_at));
    const Vec3 at = bench.position();
    worst_m = std::max(worst_m, (at - exact_at).norm());
    deepest_m = std::min(deepest_m, at.y());
    EXPECT_TRUE(exact.write(wall(exact_at, kStiffness)));
    EXPECT_TRUE(bench.device.write(wall(at, kStiffness)));
    exact.elapse(1);
    bench.device.elapse(1);
  }
  EXPECT_LT(deepest_m, -2e-3);
  EXPECT_LE(worst_m, bound_m);
  EXPECT_GT(worst_m, 0.01 * resolution_m);  // encoders do round
  EXPECT_EQ(bench.figure("reports_lost"), 0);
  EXPECT_EQ(bench.figure("reports_garbled"), 0);
  EXPECT_EQ(bench.figure("reports_implausible"), 0);
  EXPECT_EQ(bench.figure("reports_written"), 3000);
}

TEST(PolhemDevice, ExertsTheForceThatItIsTold) {
  Bench bench(rest());
  const Vec3 force(0.5, -1, 2);
  bench.pass(1, force);
  // Half a milliampere of a motor of 0.0538 Nm/A on a body ten times as large, at a lever of 0.04 m or more: 0.007 N.
  EXPECT_NEAR((bench.emulated.force_D() - force).norm(), 0, 0.02);
  EXPECT_EQ(bench.device.held(force), force);
}

// All currents are cut alike: the force keeps its direction, and what it holds is told to the safety gate.
TEST(PolhemDevice, CutsCurrentsAndKeepsTheDirection) {
  PolhemParameters p = known();
  p.current_limit_A = 0.2;
  p.force_limit_N = 50;
  Bench bench(rest(), p);
  const Vec3 force(3, -4, 5);
  bench.pass(1, force);
  EXPECT_LE(bench.emulated.currents_A().cwiseAbs().maxCoeff(), 0.2 + 1e-12);
  EXPECT_GE(bench.emulated.currents_A().cwiseAbs().maxCoeff(), 0.199);
  const Vec3 held = bench.device.held(force);
  EXPECT_NEAR(held.normalized().dot(force.normalized()), 1, 1e-12);
  EXPECT_LT(held.norm(), 0.9 * force.norm());
  EXPECT_NEAR((bench.emulated.force_D() - held).norm(), 0, 0.02);
  p.current_limit_A = 3;
  p.force_limit_N = 2;
  EXPECT_NEAR(Bench(rest(), p).device.held(force).norm(), 2, 1e-12);
}

TEST(PolhemDevice, ExertsNothingBeforeItMay) {
  struct Case {
    PolhemParameters parameters;
    bool calibrated;
    ForceOff why;
  };
  PolhemParameters no_limit = known(), no_force = known();
  no_limit.current_limit_A = 0;
  no_force.force_limit_N = 0;
  for (const Case& c : {Case{known(), false, ForceOff::kUncalibrated}, Case{no_limit, true, ForceOff::kNoCurrentLimit},
                        Case{no_force, true, ForceOff::kLimitZero}}) {
    Bench bench(rest(), c.parameters, c.calibrated);
    EXPECT_EQ(bench.device.forceOff(), c.why);
    bench.pass(5, Vec3(1, 1, 1));
    EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
    EXPECT_EQ(bench.device.held(Vec3(1, 1, 1)), Vec3::Zero());
  }
}

// The button asks, the host tells the device to count from home, and forces are on from zero.
TEST(PolhemDevice, IsCalibratedByItsButton) {
  const PolhemParameters p = known();
  const ArmKinematics arm(p.joints, p.origin_m);
  const Vec3 home_A = arm.position(arm.angles({0, 0, -5000}));
  const SampledPath at_home({0}, {Vec3(home_A.y(), home_A.z(), home_A.x())}, SampledPath::Interpolation::kLinear);
  Bench bench(at_home, p, false);
  bench.pass(3);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_GT((bench.position() - at_home.position(0)).norm(), 0.05);
  bench.emulated.pressCalibration();
  bench.pass(4, Vec3(0, 1, 0));  // three reports say it, then the device is told
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  bench.pass(2, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
  EXPECT_NEAR((bench.position() - at_home.position(0)).norm(), 0, bench.device.limits().position_resolution_m);
  EXPECT_EQ(bench.figure("calibrations"), 1);
  EXPECT_EQ(bench.figure("reports_implausible"), 0);
  EXPECT_NEAR((bench.emulated.force_D() - Vec3(0, 1, 0)).norm(), 0, 0.02);
}

// While the command to count from home is on its way no current flows, also if the servo wants one.
TEST(PolhemDevice, ExertsNothingWhileItIsCalibrated) {
  Bench bench(rest());
  bench.pass(2, Vec3(0, 1, 0));
  bench.device.calibrate();
  EXPECT_EQ(bench.device.held(Vec3(0, 1, 0)), Vec3::Zero());
  bench.pass(1, Vec3(0, 1, 0));
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
}

TEST(PolhemDevice, TellsThatItIsUnpluggedAndComesBackWithoutForce) {
  Bench bench(rest());
  bench.pass(5, Vec3(0, 1, 0));
  bench.cable.unplugged = true;
  bench.device.elapse(1);
  Vec3 before(1, 2, 3);
  EXPECT_FALSE(bench.device.read(before));
  EXPECT_EQ(before, Vec3(1, 2, 3));
  EXPECT_TRUE(bench.device.write(Vec3(0, 1, 0)));
  EXPECT_EQ(bench.device.held(Vec3(0, 1, 0)), Vec3::Zero());
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kDisconnected);
  bench.emulated.restart();
  bench.pass(3, Vec3(0, 1, 0));
  bench.cable.unplugged = false;
  bench.pass(3, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  EXPECT_EQ(bench.figure("disconnects"), 1);
  EXPECT_EQ(bench.figure("reconnects"), 1);
  EXPECT_EQ(bench.figure("reports_implausible"), 0);
}

// What was wanted before the cable was pulled is not what the device gets first when it is back.
TEST(PolhemDevice, GetsNoOldCommandWhenItIsBack) {
  Bench bench(rest());
  bench.pass(5, Vec3(0, 1, 0));
  EXPECT_TRUE(bench.device.write(Vec3(0, 1, 0)));
  bench.cable.unplugged = true;
  bench.device.elapse(1);
  bench.emulated.restart();
  bench.cable.unplugged = false;
  bench.device.elapse(1);  // opens it, and writes before the servo has said anything
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
}

// It was switched off and on without the host's noticing: it counts from 0, elsewhere than the handle is.
TEST(PolhemDevice, IsNotCalibratedAnyMoreWhenItCountsFromElsewhere) {
  Bench bench(rest());
  bench.pass(5, Vec3(0, 1, 0));
  const Vec3 before = bench.position();
  bench.emulated.restart();
  bench.pass(1, Vec3(0, 1, 0));
  EXPECT_EQ((bench.position() - before).norm(), 0);  // not believed yet
  EXPECT_GT(bench.device.reportAge_ns(), 0);
  bench.pass(4, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  EXPECT_GE(bench.figure("reports_implausible"), 3);
}

// Encoders of so many counts that 16 bits hold a part of the workspace only.
TEST(PolhemDevice, CountsBeyondSixteenBits) {
  PolhemParameters p = known();
  for (ArmJoint& joint : p.joints) joint.counts_per_turn = 100'000;
  const ArmKinematics arm(p.joints, p.origin_m);
  Bench bench(press(), p, false);  // counts from 0 where the path begins
  const auto true_counts = [&] {
    const Vec3 at = bench.emulated.hand().position_W;
    return arm.countsAt(arm.anglesAt(Vec3(at.z(), at.x(), at.y())).value());
  };
  const ArmCounts begin = true_counts();
  std::int64_t largest = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    bench.pass(1);
    const ArmCounts now = true_counts();
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(bench.device.counts()[k], now[k] - begin[k]) << "encoder " << k << ", tick " << tick;
      largest = std::max(largest, std::abs(now[k] - begin[k]));
    }
  }
  EXPECT_GT(largest, 40'000);
}

// The switch of the handle, as the newest report that counts says.
TEST(PolhemDevice, TellsItsSwitch) {
  Bench bench(rest());
  bench.pass(3);
  EXPECT_FALSE(bench.device.pressed());
  bench.emulated.press(true);
  bench.pass(1);
  EXPECT_TRUE(bench.device.pressed());
  bench.emulated.press(false);
  bench.pass(1);
  EXPECT_FALSE(bench.device.pressed());
}

// The switch is a clutch: while it is pressed the motors exert nothing, whatever the servo wants, and the tool stays.
TEST(PolhemDevice, ExertsNothingWhileItsSwitchIsPressed) {
  const PolhemParameters p = known();
  EmulatedPolhem emulated(p, {}, press(), kTick_s);
  EmulatedCable cable(emulated);
  PlacedDevice device(
      std::make_shared<PolhemDevice>(p, PolhemUse{.simulated_clock = true, .rate_hz = 1 / kTick_s, .calibrated = true},
                                     cable.opener()),
      {});
  Vec3 at = Vec3::Zero(), held_at = Vec3::Zero();
  const auto pass = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      device.elapse(1);
      ASSERT_TRUE(device.read(at));
      static_cast<void>(device.write(Vec3(0, 1, 0)));
    }
  };
  pass(100);
  EXPECT_GT(emulated.currents_A().norm(), 0.01);
  emulated.press(true);
  pass(2);
  held_at = at;
  pass(300);
  EXPECT_EQ(emulated.currents_A(), Vec3::Zero());
  EXPECT_LT((at - held_at).norm(), 1e-12);
  emulated.press(false);
  pass(3);
  EXPECT_GT(emulated.currents_A().norm(), 0.01);
}

PolhemParameters atZero() {  // an arm whose home is where its counts are 0, as those of WoodenHaptics
  PolhemParameters p = known();
  p.home_counts = {0, 0, 0};
  return p;
}

// The button was pressed, the command to count from home was never heard since the cable was pulled: an arm that counts
// from 0 wherever it is switched on then looks as if it were at home.
TEST(PolhemDevice, IsNotCalibratedByARequestThatWasLostWithTheCable) {
  Bench bench(rest(), atZero(), false);
  bench.pass(1);
  bench.emulated.pressCalibration();
  bench.pass(3);
  bench.cable.refuses = true;
  bench.device.elapse(1);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kDisconnected);
  bench.emulated.restart();
  bench.cable.unplugged = false;
  bench.pass(20, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  EXPECT_EQ(bench.figure("calibrations"), 0);
}

// The link is in the middle of an exchange when the calibration is asked for. That exchange's answer is new, of the
// same connection, at home and without the button: only the number of the request tells that it came before.
TEST(PolhemDevice, IsNotCalibratedByAnAnswerToWhatWasWrittenBefore) {
  std::atomic<bool> gated{false};
  std::counting_semaphore<> entered{0}, let{0};
  EmulatedPolhem emulated(atZero(), {}, rest(), kTick_s, false);  // counts 0 where it is: as if at home
  EmulatedCable cable(emulated);
  cable.pace = std::chrono::milliseconds(1);
  cable.spoil = [&](const Report& answer) {
    if (gated) {
      entered.release();
      let.acquire();
    }
    return std::optional(answer);
  };
  PolhemDevice device(atZero(), {.rate_hz = 1000}, cable.opener());
  struct Open {  // after the device, whose destructor waits for the thread
    std::atomic<bool>& gated;
    std::counting_semaphore<>& let;
    ~Open() {
      gated = false;
      let.release();
    }
  } open{gated, let};
  const auto figure = [&](std::string_view key) {
    for (const DeviceFigure& f : device.figures())
      if (f.key == key) return f.value;
    return -1.0;
  };
  const auto stops = [&] { return entered.try_acquire_for(std::chrono::seconds(5)); };
  Vec3 at;
  gated = true;
  ASSERT_TRUE(stops());  // within a write of no command
  EXPECT_TRUE(device.read(at));
  device.calibrate();
  // That write's answer, and then the command's, after which one more may have been on its way.
  for (const bool calibrated : {false, false, true}) {
    const double received = figure("reports_received");
    let.release();
    ASSERT_TRUE(stops());
    EXPECT_EQ(figure("reports_received"), received + 1);
    EXPECT_TRUE(device.read(at));
    EXPECT_EQ(device.forceOff(), calibrated ? ForceOff::kNone : ForceOff::kUncalibrated);
    EXPECT_EQ(figure("calibrations"), calibrated ? 1 : 0);
    EXPECT_EQ(device.held(Vec3(0, 1, 0)), calibrated ? Vec3(0, 1, 0) : Vec3(0, 0, 0));
  }
  EXPECT_EQ(figure("reports_implausible"), 0);
}

// The firmware holds what its button asked. The handle may have been elsewhere then.
TEST(PolhemDevice, IsNotCalibratedByAButtonOfSomeTimeBefore) {
  for (const bool calibrated : {false, true}) {
    EmulatedPolhem emulated(known(), {}, rest(), kTick_s, calibrated);
    emulated.pressCalibration();
    EmulatedCable cable(emulated);
    PolhemDevice device(known(), {.simulated_clock = true, .calibrated = calibrated, .answer_ms = 0}, cable.opener());
    const auto pass = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) {
        static_cast<void>(device.write(Vec3(0, 1, 0)));
        device.elapse(1);
      }
    };
    pass(20);
    EXPECT_EQ(device.forceOff(), ForceOff::kUncalibrated);  // the arm counts from elsewhere now
    EXPECT_EQ(emulated.currents_A(), Vec3::Zero());
    emulated.pressCalibration();  // it may be pressed again
    pass(20);
    EXPECT_EQ(device.forceOff(), ForceOff::kNone);
  }
}

// Nor by one that was pressed while nothing was heard for a while.
TEST(PolhemDevice, IsNotCalibratedByAButtonThatWasPressedUnseen) {
  for (const int silent : {90, 110}) {
    Bench bench(rest());
    bench.pass(5);
    bench.cable.spoil = [](const Report&) { return std::nullopt; };
    bench.pass(silent);
    bench.emulated.pressCalibration();
    bench.cable.spoil = {};
    bench.pass(20);
    EXPECT_EQ(bench.device.forceOff(), silent < 100 ? ForceOff::kNone : ForceOff::kUncalibrated) << silent;
    EXPECT_EQ(bench.figure("calibrations"), silent < 100 ? 1 : 0) << silent;
  }
}

// One report that asks for it, as a damaged one may, makes a calibrated arm count from nowhere else.
TEST(PolhemDevice, IsNotCalibratedByOneOddReport) {
  Bench bench(rest());
  bench.pass(5, Vec3(0, 1, 0));
  const Vec3 before = bench.position();
  for (int odd = 1; odd <= 2; ++odd) {
    bench.emulated.pressCalibration();
    for (int i = 0; i < odd; ++i) bench.pass(1, Vec3(0, 1, 0));
    bench.emulated.releaseCalibration();
    bench.pass(5, Vec3(0, 1, 0));
    EXPECT_EQ(bench.figure("calibrations"), 0);
    EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
    EXPECT_LT((bench.position() - before).norm(), 5e-3);
  }
}

// It says nothing, and then counts from 0: after a short silence its place is one that no hand reaches, after a long
// one nothing of what was known holds.
TEST(PolhemDevice, IsNotCalibratedAnyMoreWhenItStartedAnewInSilence) {
  for (const bool garbled : {false, true}) {
    for (const int silent : {1, 20, 100, 400, 499, 500, 2000}) {
      Bench bench(rest());
      bench.pass(5, Vec3(0, 1, 0));
      bench.cable.spoil = [&](Report answer) {
        answer.size = 3;
        return garbled ? std::optional(answer) : std::nullopt;
      };
      bench.pass(silent, Vec3(0, 1, 0));
      bench.emulated.restart();
      bench.cable.spoil = {};
      bench.pass(5, Vec3(0, 1, 0));
      EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated) << silent;
      EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero()) << silent;
    }
  }
}

// By the real clock the link notices it, however seldom the servo looks.
TEST(PolhemDevice, ForgetsInSilenceAlsoUnseen) {
  for (const int silent_ms : {200, 700}) {
    EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
    EmulatedCable cable(emulated);
    cable.pace = std::chrono::milliseconds(1);
    std::atomic<bool> silent{false};
    cable.spoil = [&](const Report& answer) { return silent ? std::nullopt : std::optional(answer); };
    PolhemDevice device(known(), {.rate_hz = 1000, .calibrated = true}, cable.opener());
    EXPECT_EQ(device.forceOff(), ForceOff::kNone);
    silent = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(silent_ms));
    silent = false;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    Vec3 at;
    EXPECT_TRUE(device.read(at) || silent_ms > 500);
    EXPECT_TRUE(device.read(at));
    EXPECT_EQ(device.forceOff(), silent_ms < 500 ? ForceOff::kNone : ForceOff::kUncalibrated) << silent_ms;
  }
}

// The bus has it again, but nothing has come yet: where it is and whether it is calibrated is not known.
TEST(PolhemDevice, IsNotThereBeforeItsFirstReportOfANewConnection) {
  Bench bench(rest());
  bench.pass(5, Vec3(0, 1, 0));
  bench.cable.unplugged = true;
  bench.device.elapse(1);
  bench.emulated.restart();
  bench.cable.unplugged = false;
  bench.cable.says_itself = false;
  bench.cable.spoil = [](const Report&) { return std::nullopt; };
  for (int i = 0; i < 5; ++i) {
    bench.device.elapse(1);
    EXPECT_EQ(bench.device.forceOff(), ForceOff::kDisconnected);
    Vec3 position;
    EXPECT_FALSE(bench.device.read(position));
    EXPECT_TRUE(bench.device.write(Vec3(0, 1, 0)));
    EXPECT_EQ(bench.device.held(Vec3(0, 1, 0)), Vec3::Zero());
    EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  }
  bench.cable.spoil = {};
  bench.pass(3, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
}

// Replugged before its first report was taken: what was said at the start is of the connection before.
TEST(PolhemDevice, IsNotCalibratedIfItWasAwayBeforeItsFirstReport) {
  EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
  EmulatedCable cable(emulated);
  cable.says_itself = false;
  cable.refuses = true;  // the first write
  const PortOpener open = cable.opener();
  const auto again = [&]() -> std::unique_ptr<ReportPort> {
    cable.unplugged = false;
    return open();
  };
  const PolhemDevice device(known(), {.simulated_clock = true, .calibrated = true}, again);
  EXPECT_EQ(device.forceOff(), ForceOff::kUncalibrated);
}

// Counts that jump by as little as 15 mm, from one millisecond to the next, and stay there: the arm was switched off
// and on where it stood. A hand that moves as fast as one can is no jump.
TEST(PolhemDevice, NoticesThatItCountsFromNearBy) {
  Bench jumps(rest());
  jumps.pass(5);
  const PolhemParameters p = known();
  const ArmKinematics arm(p.joints, p.origin_m);
  const Vec3 here = rest().position(0);
  const ArmCounts near = arm.countsAt(arm.anglesAt(Vec3(here.z(), here.x() + 0.015, here.y())).value());
  const ArmCounts now = arm.countsAt(arm.anglesAt(Vec3(here.z(), here.x(), here.y())).value());
  jumps.cable.spoil = [&](const Report& answer) {
    auto state = parsePolhem(answer.content(), answer.size);
    for (std::size_t k = 0; k < 3; ++k)
      state->counts[k] = static_cast<std::int16_t>(state->counts[k] + near[k] - now[k]);
    return polhemStateReport(*state, answer.size);
  };
  jumps.pass(4, Vec3(0, 1, 0));
  EXPECT_EQ(jumps.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(jumps.figure("reports_implausible"), 3);

  const SampledPath fast({0, 0.01, 0.03}, {Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(0.1, 0, 0)},
                         SampledPath::Interpolation::kLinear);  // 5 m/s
  HandParameters light;
  light.hand_stiffness_N_per_m = 1e5;
  Bench moves(fast, known(), true, light);
  moves.pass(40);
  EXPECT_EQ(moves.device.forceOff(), ForceOff::kNone);
  EXPECT_EQ(moves.figure("reports_implausible"), 0);
}

// The link's thread reads one answer 50 ms after the arm gave it, in which a hand at 1 m/s went on by 50 mm: the next
// answer comes a millisecond later, and is believed.
TEST(PolhemDevice, BelievesAHandWhoseReportsAreReadLate) {
  const SampledPath path({0, 0.02, 0.16}, {Vec3(-0.07, 0, 0), Vec3(-0.07, 0, 0), Vec3(0.07, 0, 0)},
                         SampledPath::Interpolation::kLinear);
  HandParameters hand;
  hand.hand_stiffness_N_per_m = 1e5;
  EmulatedPolhem emulated(known(), hand, path, kTick_s);
  EmulatedCable cable(emulated);
  cable.pace = std::chrono::milliseconds(1);
  int answers = 0;
  cable.spoil = [&](const Report& answer) {
    if (++answers == 60) {
      emulated.passSilence(0.05);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return std::optional(answer);
  };
  PolhemDevice device(known(), {.rate_hz = 1000, .calibrated = true}, cable.opener());
  Vec3 at;
  for (int i = 0; i < 400; ++i) {
    static_cast<void>(device.read(at));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(device.forceOff(), ForceOff::kNone);
  for (const DeviceFigure& f : device.figures()) {
    EXPECT_TRUE(f.key != "reports_implausible" || f.value == 0) << f.value;
  }
}

// A sleep is never shorter than asked for, so a period is 5 ms at least. A cable that takes no time gives 16 reports in
// far less than 16 ticks of 10 ms.
TEST(PolhemDevice, KnowsThePaceOfItsReports) {
  const auto made = [](std::chrono::microseconds pace, double rate_hz) {
    EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
    EmulatedCable cable(emulated);
    cable.pace = pace;
    const PolhemDevice device(known(), {.rate_hz = rate_hz, .calibrated = true}, cable.opener());
    double period_us = 0;
    for (const DeviceFigure& f : device.figures()) {
      if (f.key == "report_period_us") period_us = f.value;
    }
    return std::pair(device.limits().force_delay_ticks, period_us);
  };
  const auto [slow_ticks, slow_us] = made(std::chrono::milliseconds(5), 1000);
  EXPECT_GE(slow_ticks, 5);
  EXPECT_GE(slow_us, 5000);
  const auto [quick_ticks, quick_us] = made(std::chrono::microseconds(0), 100);
  EXPECT_EQ(quick_ticks, 1);
  EXPECT_GT(quick_us, 0);
  EXPECT_LT(quick_us, 10'000);
  EXPECT_EQ(Bench(rest()).device.limits().force_delay_ticks, 0);  // by the simulated clock each tick has its report
}

// While the pace is measured: reports that are none do not make it seem quick, and some that are lost not slow.
TEST(PolhemDevice, KnowsThePaceBesideTrouble) {
  const auto periodOf = [](const std::function<std::optional<Report>(int, Report)>& spoil) {
    EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
    EmulatedCable cable(emulated);
    cable.pace = std::chrono::milliseconds(4);
    int answers = 0;
    cable.spoil = [&](const Report& answer) { return spoil(++answers, answer); };
    const PolhemDevice device(known(), {.rate_hz = 100, .calibrated = true}, cable.opener());
    for (const DeviceFigure& f : device.figures()) {
      if (f.key == "report_period_us") return f.value;
    }
    return 0.0;
  };
  const auto garbled = [](Report report) {
    report.size = 3;
    return report;
  };
  const double half = periodOf([&](int n, const Report& r) { return n % 2 == 0 ? garbled(r) : r; });
  EXPECT_GE(half, 4000);
  // After the first report nothing but garbage: it is not known to be quick.
  const double none = periodOf([&](int n, const Report& r) { return n > 1 ? garbled(r) : r; });
  EXPECT_GE(none, 60'000);
  // Every fifth answer is lost, which costs 10 ms each: the middle of the others is the pace.
  const double lossy = periodOf([](int n, const Report& r) { return n % 5 == 0 ? std::nullopt : std::optional(r); });
  EXPECT_GE(lossy, 4000);
  EXPECT_LT(lossy, 14'000);  // one that follows a loss takes 4 + 10 + 4 ms
}

TEST(PolhemDevice, RefusesToBeTooSlowForTheRate) {
  EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
  EmulatedCable cable(emulated);
  cable.pace = std::chrono::milliseconds(4);
  try {
    const PolhemDevice device(known(), {.rate_hz = 20'000, .calibrated = true}, cable.opener());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), testing::HasSubstr("ticks of the servo; lower --rate"));
  }
}

TEST(PolhemDevice, RefusesWhatIsNoPolhem) {
  EmulatedPolhem emulated(known(), {}, rest(), kTick_s);
  EmulatedCable cable(emulated);
  PolhemParameters teensy = known();
  teensy.report_bytes = 64;
  try {
    const PolhemDevice device(teensy, {.simulated_clock = true}, cable.opener());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), testing::HasSubstr("not those of a Polhem with 64 bytes"));
  }
  PolhemParameters bad = known();
  bad.report_bytes = 20;
  EXPECT_THROW(PolhemDevice(bad, {.simulated_clock = true}, cable.opener()), Error);
}

}  // namespace polhem_device_test
}  // namespace palpate
