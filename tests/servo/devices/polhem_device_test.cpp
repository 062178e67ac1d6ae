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
#include "support/polhem_bench.hpp"

namespace palpate {
namespace polhem_device_test {

Vec3 wall(const Vec3& position, double stiffness) {
  return position.y() < 0 ? Vec3(0, -stiffness * position.y(), 0) : Vec3(Vec3::Zero());
}

// Half a count of each encoder moves the handle by half a column of the Jacobian, 0.5 (0.18 + 0.18 + 0.14) / 2 pi /
// 20000 ... in all less than one resolution; the wall turns that into a force, and the hand's spring of 400 N/m yields
// to it by K / 400 as much. A current's half milliampere is 0.03 N / 400 N/m at most of that size again.
TEST(PolhemDevice, FeelsAWallAsTheSimulatedDeviceDoes) {
  constexpr double kStiffness = 600;
  PolhemBench bench(pressed());
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  p.force_limit_N = 5;
  SimulatedDevice exact(p, pressed(), 1 / kPolhemTick_s);
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
  PolhemBench bench(resting());
  const Vec3 force(0.5, -1, 2);
  bench.pass(1, force);
  // Half a milliampere of a motor of 0.0538 Nm/A on a body ten times as large, at a lever of 0.04 m or more: 0.007 N.
  EXPECT_NEAR((bench.emulated.force_D() - force).norm(), 0, 0.02);
  EXPECT_EQ(bench.device.held(force), force);
}

// All currents are cut alike: the force keeps its direction, and what it holds is told to the safety gate.
TEST(PolhemDevice, CutsCurrentsAndKeepsTheDirection) {
  PolhemParameters p = knownPolhem();
  p.current_limit_A = 0.2;
  p.force_limit_N = 50;
  PolhemBench bench(resting(), p);
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
  EXPECT_NEAR(PolhemBench(resting(), p).device.held(force).norm(), 2, 1e-12);
}

TEST(PolhemDevice, ExertsNothingBeforeItMay) {
  struct Case {
    PolhemParameters parameters;
    bool calibrated;
    ForceOff why;
  };
  PolhemParameters no_limit = knownPolhem(), no_force = knownPolhem();
  no_limit.current_limit_A = 0;
  no_force.force_limit_N = 0;
  for (const Case& c : {Case{knownPolhem(), false, ForceOff::kUncalibrated},
                        Case{no_limit, true, ForceOff::kNoCurrentLimit}, Case{no_force, true, ForceOff::kLimitZero}}) {
    PolhemBench bench(resting(), c.parameters, c.calibrated);
    EXPECT_EQ(bench.device.forceOff(), c.why);
    bench.pass(5, Vec3(1, 1, 1));
    EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
    EXPECT_EQ(bench.device.held(Vec3(1, 1, 1)), Vec3::Zero());
  }
}

TEST(PolhemDevice, TellsThatItIsUnpluggedAndComesBackWithoutForce) {
  PolhemBench bench(resting());
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
  PolhemBench bench(resting());
  bench.pass(5, Vec3(0, 1, 0));
  EXPECT_TRUE(bench.device.write(Vec3(0, 1, 0)));
  bench.cable.unplugged = true;
  bench.device.elapse(1);
  bench.emulated.restart();
  bench.cable.unplugged = false;
  bench.device.elapse(1);  // opens it, and writes before the servo has said anything
  EXPECT_EQ(bench.emulated.currents_A(), Vec3::Zero());
}

// Encoders of so many counts that 16 bits hold a part of the workspace only.
TEST(PolhemDevice, CountsBeyondSixteenBits) {
  PolhemParameters p = knownPolhem();
  for (ArmJoint& joint : p.joints) joint.counts_per_turn = 100'000;
  const ArmKinematics arm(p.joints, p.origin_m);
  PolhemBench bench(pressed(), p, false);  // counts from 0 where the path begins
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
  PolhemBench bench(resting());
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
  const PolhemParameters p = knownPolhem();
  EmulatedPolhem emulated(p, {}, pressed(), kPolhemTick_s);
  EmulatedCable cable(emulated);
  PlacedDevice device(
      std::make_shared<PolhemDevice>(
          p,
          PolhemUse{.simulated_clock = true, .rate_hz = 1 / kPolhemTick_s, .calibrated = true, .motors_checked = true},
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

// The link's thread reads one answer 50 ms after the arm gave it, in which a hand at 1 m/s went on by 50 mm: the next
// answer comes a millisecond later, and is believed.
TEST(PolhemDevice, BelievesAHandWhoseReportsAreReadLate) {
  const SampledPath path({0, 0.02, 0.16}, {Vec3(-0.07, 0, 0), Vec3(-0.07, 0, 0), Vec3(0.07, 0, 0)},
                         SampledPath::Interpolation::kLinear);
  HandParameters hand;
  hand.hand_stiffness_N_per_m = 1e5;
  EmulatedPolhem emulated(knownPolhem(), hand, path, kPolhemTick_s);
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
  PolhemDevice device(knownPolhem(), {.rate_hz = 1000, .calibrated = true, .motors_checked = true}, cable.opener());
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
    EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
    EmulatedCable cable(emulated);
    cable.pace = pace;
    const PolhemDevice device(knownPolhem(), {.rate_hz = rate_hz, .calibrated = true, .motors_checked = true},
                              cable.opener());
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
  EXPECT_EQ(PolhemBench(resting()).device.limits().force_delay_ticks,
            0);  // by the simulated clock each tick has its report
}

// While the pace is measured: reports that are none do not make it seem quick, and some that are lost not slow.
TEST(PolhemDevice, KnowsThePaceBesideTrouble) {
  const auto periodOf = [](const std::function<std::optional<Report>(int, Report)>& spoil) {
    EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
    EmulatedCable cable(emulated);
    cable.pace = std::chrono::milliseconds(4);
    int answers = 0;
    cable.spoil = [&](const Report& answer) { return spoil(++answers, answer); };
    const PolhemDevice device(knownPolhem(), {.rate_hz = 100, .calibrated = true, .motors_checked = true},
                              cable.opener());
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
  EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
  EmulatedCable cable(emulated);
  cable.pace = std::chrono::milliseconds(4);
  try {
    const PolhemDevice device(knownPolhem(), {.rate_hz = 20'000, .calibrated = true, .motors_checked = true},
                              cable.opener());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), testing::HasSubstr("ticks of the servo; lower --rate"));
  }
}

TEST(PolhemDevice, RefusesWhatIsNoPolhem) {
  EmulatedPolhem emulated(knownPolhem(), {}, resting(), kPolhemTick_s);
  EmulatedCable cable(emulated);
  PolhemParameters teensy = knownPolhem();
  teensy.report_bytes = 64;
  try {
    const PolhemDevice device(teensy, {.simulated_clock = true}, cable.opener());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), testing::HasSubstr("its reports have 14 bytes, and not 64"));
  }
  // What it says is neither, and named as what it is.
  for (const auto& [bytes, words] :
       {std::pair<std::size_t, const char*>{8, "have 8 bytes, as the public streaming"},
        std::pair<std::size_t, const char*>{14, "of 14 bytes are not those of a Polhem"}}) {
    EmulatedCable other(emulated);
    other.spoil = [bytes = bytes](Report report) {
      report.size = bytes;
      report.bytes.fill(0x55);
      return std::optional(report);
    };
    other.says_itself = false;
    try {
      const PolhemDevice device(knownPolhem(), {.simulated_clock = true}, other.opener());
      FAIL();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(words));
      EXPECT_THAT(error.what(), testing::HasSubstr("; load a firmware that is driven here into it"));
    }
  }
  PolhemParameters bad = knownPolhem();
  bad.report_bytes = 20;
  EXPECT_THROW(PolhemDevice(bad, {.simulated_clock = true}, cable.opener()), Error);
}

}  // namespace polhem_device_test
}  // namespace palpate
