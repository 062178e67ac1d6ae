// SPDX-License-Identifier: Apache-2.0
// When a Polhem counts as calibrated, and when it does not any more: its button, requests, silence, leaps, cables.
#include <atomic>
#include <chrono>
#include <cmath>
#include <semaphore>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/polhem_device.hpp"
#include "support/emulated_polhem.hpp"
#include "support/polhem_bench.hpp"

namespace palpate {
namespace polhem_calibration_test {

constexpr int kRestTicks = 300;  // in which a hand that was pushed swings out, and is seen to rest

// The button asks, the host tells the device to count from home, and forces are on from zero.
TEST(PolhemCalibration, IsCalibratedByItsButton) {
  const PolhemParameters p = knownPolhem();
  const ArmKinematics arm(p.joints, p.origin_m);
  const Vec3 home_A = arm.position(arm.angles({0, 0, -5000}));
  const SampledPath at_home({0}, {Vec3(home_A.y(), home_A.z(), home_A.x())}, SampledPath::Interpolation::kLinear);
  PolhemBench bench(at_home, p, false);
  bench.pass(kRestTicks);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_GT((bench.position() - at_home.position(0)).norm(), 0.05);
  bench.emulated.pressCalibration();
  bench.pass(12, Vec3(0, 1, 0));  // the line says it for 10 ms, then the device is told
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
TEST(PolhemCalibration, ExertsNothingWhileItIsCalibrated) {
  PolhemBench bench(resting(), knownPolhem(), false);
  bench.pass(kRestTicks, Vec3(0, 1, 0));
  EXPECT_EQ(bench.device.calibrate(), CalibrationRefusal::kNone);
  EXPECT_EQ(bench.device.held(Vec3(0, 1, 0)), Vec3::Zero());
  bench.pass(1, Vec3(0, 1, 0));
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
}

// It was switched off and on without the host's noticing: it counts from 0, elsewhere than the handle is.
TEST(PolhemCalibration, IsNotCalibratedAnyMoreWhenItCountsFromElsewhere) {
  PolhemBench bench(resting());
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

PolhemParameters atZero() {  // an arm whose home is where its counts are 0, as those of WoodenHaptics
  PolhemParameters p = knownPolhem();
  p.home_counts = {0, 0, 0};
  return p;
}

// The button was pressed, the command to count from home was never heard since the cable was pulled: an arm that counts
// from 0 wherever it is switched on then looks as if it were at home.
TEST(PolhemCalibration, IsNotCalibratedByARequestThatWasLostWithTheCable) {
  PolhemBench bench(resting(), atZero(), false);
  bench.pass(kRestTicks);
  bench.emulated.pressCalibration();
  bench.pass(11);
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
TEST(PolhemCalibration, IsNotCalibratedByAnAnswerToWhatWasWrittenBefore) {
  std::atomic<bool> gated{false};
  std::counting_semaphore<> entered{0}, let{0};
  EmulatedPolhem emulated(atZero(), {}, resting(), kPolhemTick_s, false);  // counts 0 where it is: as if at home
  EmulatedCable cable(emulated);
  cable.pace = std::chrono::milliseconds(1);
  cable.spoil = [&](const Report& answer) {
    if (gated) {
      entered.release();
      let.acquire();
    }
    return std::optional(answer);
  };
  PolhemDevice device(atZero(), {.rate_hz = 1000, .motors_checked = true}, cable.opener());
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
  while (device.whyNotCalibrate() == CalibrationRefusal::kMoving) {  // it has not been seen at rest for long enough
    EXPECT_TRUE(device.read(at));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  gated = true;
  ASSERT_TRUE(stops());  // within a write of no command
  EXPECT_TRUE(device.read(at));
  EXPECT_EQ(device.calibrate(), CalibrationRefusal::kNone);
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
TEST(PolhemCalibration, IsNotCalibratedByAButtonOfSomeTimeBefore) {
  for (const bool calibrated : {false, true}) {
    EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s, calibrated);
    emulated.pressCalibration();
    EmulatedCable cable(emulated);
    PolhemDevice device(knownPolhem(),
                        {.simulated_clock = true, .calibrated = calibrated, .motors_checked = true, .answer_ms = 0},
                        cable.opener());
    const auto pass = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) {
        static_cast<void>(device.write(Vec3(0, 1, 0)));
        device.elapse(1);
      }
    };
    pass(kRestTicks);
    EXPECT_EQ(device.forceOff(), ForceOff::kUncalibrated);  // the arm counts from elsewhere now
    EXPECT_EQ(emulated.currents_A(), Vec3::Zero());
    emulated.pressCalibration();  // it may be pressed again
    pass(20);
    EXPECT_EQ(device.forceOff(), ForceOff::kNone);
  }
}

// Nor by one that was pressed while nothing was heard for a while.
TEST(PolhemCalibration, IsNotCalibratedByAButtonThatWasPressedUnseen) {
  for (const int silent : {90, 110}) {
    PolhemBench bench(resting(), knownPolhem(), false);
    bench.pass(kRestTicks);
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
TEST(PolhemCalibration, IsNotCalibratedByOneOddReport) {
  PolhemBench bench(resting());
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

// A calibrated arm tells of a pose that its joints do not allow: it is another arm, or was calibrated elsewhere. One
// that is not calibrated knows no poses.
TEST(PolhemCalibration, IsNotCalibratedAnyMoreInAPoseThatIsImpossible) {
  PolhemParameters p = knownPolhem();
  p.lowest_rad = {-0.3, -0.5, -1};
  p.highest_rad = {0.3, 1.2, 1.5};
  // To the right until joint a is turned by more than 0.3 rad: 43 mm at a radius of 140 mm.
  const auto at = [](double right_m) { return Vec3(right_m, 0, 0); };
  const SampledPath path({0, 0.05, 0.1, 0.15}, {at(0.03), at(0.03), at(0.06), at(0.06)},
                         SampledPath::Interpolation::kLinear);
  HandParameters firm;
  firm.hand_stiffness_N_per_m = 1e5;
  firm.hand_damping_Ns_per_m = 200;
  PolhemBench bench(path, p, true, firm), unknown(path, p, false, firm);
  bench.pass(50, Vec3(0, 0.2, 0));
  EXPECT_EQ(bench.figure("poses_impossible"), 0);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kNone);
  bench.pass(60, Vec3(0, 0.2, 0));
  EXPECT_EQ(bench.figure("poses_impossible"), 3);
  EXPECT_EQ(bench.figure("reports_implausible"), 0);
  EXPECT_EQ(bench.device.forceOff(), ForceOff::kUncalibrated);
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
  unknown.pass(110);
  EXPECT_EQ(unknown.figure("poses_impossible"), 0);
}

// It says nothing, and then counts from 0: after a short silence its place is one that no hand reaches, after a long
// one nothing of what was known holds.
TEST(PolhemCalibration, IsNotCalibratedAnyMoreWhenItStartedAnewInSilence) {
  for (const bool garbled : {false, true}) {
    for (const int silent : {1, 20, 100, 400, 499, 500, 2000}) {
      PolhemBench bench(resting());
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
TEST(PolhemCalibration, ForgetsInSilenceAlsoUnseen) {
  for (const int silent_ms : {200, 700}) {
    EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
    EmulatedCable cable(emulated);
    cable.pace = std::chrono::milliseconds(1);
    std::atomic<bool> silent{false};
    cable.spoil = [&](const Report& answer) { return silent ? std::nullopt : std::optional(answer); };
    PolhemDevice device(knownPolhem(), {.rate_hz = 1000, .calibrated = true, .motors_checked = true}, cable.opener());
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
TEST(PolhemCalibration, IsNotThereBeforeItsFirstReportOfANewConnection) {
  PolhemBench bench(resting());
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
TEST(PolhemCalibration, IsNotCalibratedIfItWasAwayBeforeItsFirstReport) {
  EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
  EmulatedCable cable(emulated);
  cable.says_itself = false;
  cable.refuses = true;  // the first write
  const PortOpener open = cable.opener();
  const auto again = [&]() -> std::unique_ptr<ReportPort> {
    cable.unplugged = false;
    return open();
  };
  const PolhemDevice device(knownPolhem(), {.simulated_clock = true, .calibrated = true, .motors_checked = true},
                            again);
  EXPECT_EQ(device.forceOff(), ForceOff::kUncalibrated);
}

// Counts that jump by as little as 15 mm, from one millisecond to the next, and stay there: the arm was switched off
// and on where it stood. A hand that moves as fast as one can is no jump.
TEST(PolhemCalibration, NoticesThatItCountsFromNearBy) {
  PolhemBench jumps(resting());
  jumps.pass(5);
  const PolhemParameters p = knownPolhem();
  const ArmKinematics arm(p.joints, p.origin_m);
  const Vec3 here = resting().position(0);
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

  std::vector<double> times_s = {0, 0.02};  // to 5 m/s within 10 ms, and 15 ms on
  std::vector<Vec3> points(2, Vec3::Zero());
  for (int ms = 1; ms <= 25; ++ms) {
    times_s.push_back(0.02 + 1e-3 * ms);
    points.emplace_back(ms <= 10 ? 250e-6 * ms * ms : 5e-3 * ms - 0.025, 0, 0);
  }
  const SampledPath fast(std::move(times_s), std::move(points), SampledPath::Interpolation::kLinear);
  HandParameters light;
  light.hand_stiffness_N_per_m = 1e5;
  PolhemBench moves(fast, knownPolhem(), true, light);
  moves.pass(60);
  EXPECT_EQ(moves.device.forceOff(), ForceOff::kNone);
  EXPECT_EQ(moves.figure("reports_implausible"), 0);
}

}  // namespace polhem_calibration_test
}  // namespace palpate
