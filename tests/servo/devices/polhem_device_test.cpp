// SPDX-License-Identifier: Apache-2.0
// The host's side of a Polhem against the emulated other end of its cable, by the simulated clock.
#include "servo/devices/polhem_device.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
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
        device(p, {.simulated_clock = true, .rate_hz = 1 / kTick_s, .calibrated = calibrated}, cable.opener()) {}

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
  bench.pass(3, Vec3(0, 1, 0));
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
  EXPECT_EQ(slow_ticks, std::ceil(slow_us * 1e-3 - 0.25));
  const auto [quick_ticks, quick_us] = made(std::chrono::microseconds(0), 100);
  EXPECT_EQ(quick_ticks, 1);
  EXPECT_GT(quick_us, 0);
  EXPECT_LT(quick_us, 10'000);
  EXPECT_EQ(Bench(rest()).device.limits().force_delay_ticks, 0);  // by the simulated clock each tick has its report
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
