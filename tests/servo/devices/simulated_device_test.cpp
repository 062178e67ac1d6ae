// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "servo/devices/path.hpp"

namespace palpate {
namespace simulated_device_test {

const SampledPath& ramp() {
  static const SampledPath path({0, 1}, {Vec3(0, 0, 0), Vec3(0.1, -0.05, 0.02)}, SampledPath::Interpolation::kLinear);
  return path;
}
const SampledPath& rest() {
  static const SampledPath path({0}, {Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  return path;
}

TEST(SimulatedDevice, ARigidHandIsThePathWhateverTheForce) {
  SimulatedDevice device({}, ramp(), 1000);
  Vec3 read_W;
  for (int tick = 0; tick < 1100; ++tick) {
    ASSERT_TRUE(device.read(read_W));
    ASSERT_EQ(read_W, ramp().position(tick / 1000.0));
    if (tick > 0) {
      // The path's own mean velocity over the last tick.
      const Vec3 way_W = ramp().position(tick / 1000.0) - ramp().position((tick - 1) / 1000.0);
      ASSERT_LE((device.state().velocity_W - way_W * 1000).norm(), 1e-9);
    }
    ASSERT_TRUE(device.write(Vec3(5, 5, 5)));
    device.elapse(1);
  }
}

// The hand's spring carries the force: at rest the device stands off by F / k.
TEST(SimulatedDevice, ASpringHandYieldsToTheForce) {
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  SimulatedDevice device(p, rest(), 1000);
  for (int tick = 0; tick < 3000; ++tick) {
    ASSERT_TRUE(device.write(Vec3(0, 4, 0)));
    device.elapse(1);
  }
  // e^(-b t / 2m) is e^(-31) after 3 s.
  EXPECT_NEAR(device.state().position_W.y(), 4 / p.dynamics.hand_stiffness_N_per_m, 1e-12);
}

// A mass on a spring, under a force that begins at once, swings about F / k: in seconds, not in ticks, so every rate
// sees the same curve.
TEST(SimulatedDevice, ASpringHandSwingsInItsOwnTimeAtAnyRate) {
  SimulatedDeviceParameters p;
  p.hand = Hand::kSpring;
  const HandParameters& hand = p.dynamics;
  const double mass_kg = hand.hand_mass_kg + hand.device_mass_kg;
  const double decay_per_s = (hand.hand_damping_Ns_per_m + hand.device_damping_Ns_per_m) / (2 * mass_kg);
  const double swing_per_s = std::sqrt(hand.hand_stiffness_N_per_m / mass_kg - decay_per_s * decay_per_s);
  constexpr double kForce_N = 4;
  for (const double rate_hz : {333.0, 1000.0, 8000.0}) {
    SimulatedDevice device(p, rest(), rate_hz);
    for (int tick = 0; tick < static_cast<int>(0.3 * rate_hz); ++tick) {
      const double t_s = tick / rate_hz;
      const double left = std::exp(-decay_per_s * t_s) *
                          (std::cos(swing_per_s * t_s) + decay_per_s / swing_per_s * std::sin(swing_per_s * t_s));
      // The exact solution at every tick, but for the roundings of so many steps of 1e-16 of 10 mm.
      ASSERT_NEAR(device.state().position_W.z(), kForce_N / hand.hand_stiffness_N_per_m * (1 - left), 1e-13)
          << rate_hz << " Hz, tick " << tick;
      ASSERT_TRUE(device.write(Vec3(0, 0, kForce_N)));
      device.elapse(1);
    }
  }
}

TEST(SimulatedDevice, EncodersRoundToMultiplesAndHideNoMotion) {
  SimulatedDeviceParameters p;
  p.encoder_resolution_m = 30e-6;
  SimulatedDevice device(p, ramp(), 1000);
  Vec3 read_W;
  int different = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_TRUE(device.read(read_W));
    for (int i = 0; i < 3; ++i) {
      const double counts = read_W[i] / p.encoder_resolution_m;
      ASSERT_NEAR(counts, std::round(counts), 1e-9);
      ASSERT_LE(std::abs(read_W[i] - device.state().position_W[i]), 0.5 * p.encoder_resolution_m * (1 + 1e-9));
    }
    different += read_W == device.state().position_W ? 0 : 1;
    device.elapse(1);
  }
  EXPECT_GT(different, 500);  // most places of the path are no multiples
}

TEST(SimulatedDevice, AForceActsSoManyTicksLater) {
  for (int delay : {0, 1, 2, 3, 4}) {
    SimulatedDeviceParameters p;
    p.delay_ticks = delay;
    SimulatedDevice device(p, rest(), 1000);
    for (int tick = 0; tick < 10; ++tick) {
      ASSERT_TRUE(device.write(Vec3(tick + 1, 0, 0) * 0.1));
      EXPECT_DOUBLE_EQ(device.actingForce().x(), tick < delay ? 0.0 : (tick + 1 - delay) * 0.1) << delay << " " << tick;
      device.elapse(1);
    }
  }
}

// Where the servo misses ticks the device holds the last force, as hardware does; the delay still runs in ticks.
TEST(SimulatedDevice, HoldsTheLastForceOverMissedTicks) {
  SimulatedDeviceParameters p;
  p.delay_ticks = 2;
  SimulatedDevice device(p, rest(), 1000);
  ASSERT_TRUE(device.write(Vec3(1, 0, 0)));
  device.elapse(1);
  EXPECT_EQ(device.actingForce().x(), 0);
  device.elapse(4);
  EXPECT_EQ(device.actingForce().x(), 1);
}

// Whatever the delay: the force acts from then on, and so does the next one after it.
TEST(SimulatedDevice, HoldsAForceUntilTheNextOneActs) {
  for (int delay = 0; delay <= 4; ++delay) {
    SimulatedDeviceParameters p;
    p.delay_ticks = delay;
    SimulatedDevice device(p, rest(), 1000);
    for (const double force_N : {1.0, 2.0}) {
      ASSERT_TRUE(device.write(Vec3(force_N, 0, 0)));
      for (int tick = 0; tick < 12; ++tick) {
        EXPECT_EQ(device.actingForce().x(), tick < delay ? force_N - 1 : force_N) << delay << " " << tick;
        device.elapse(1);
      }
    }
  }
}

TEST(SimulatedDevice, BeginsAtItsPathsStartAndSaysWhichHandItHas) {
  const SampledPath path({0, 1}, {Vec3(0.1, 0.2, 0.3), Vec3(0.4, 0.6, 0.9)}, SampledPath::Interpolation::kLinear);
  for (const Hand hand : {Hand::kRigid, Hand::kSpring}) {
    SimulatedDeviceParameters p;
    p.hand = hand;
    SimulatedDevice device(p, path, 1000);
    Vec3 read_W;
    ASSERT_TRUE(device.read(read_W));
    EXPECT_EQ(read_W, Vec3(0.1, 0.2, 0.3));
    EXPECT_EQ(device.name(), hand == Hand::kRigid ? "simulated, rigid hand" : "simulated, spring hand");
  }
}

TEST(SimulatedDevice, CutsTheForceToItsMaximum) {
  SimulatedDevice device({}, rest(), 1000);
  ASSERT_TRUE(device.write(Vec3(0, 30, 40)));
  EXPECT_TRUE(device.actingForce().isApprox(Vec3(0, 4.8, 6.4)));
  EXPECT_FALSE(device.write(Vec3(0, NAN, 0)));
  EXPECT_TRUE(device.actingForce().isApprox(Vec3(0, 4.8, 6.4)));
  // And says so; what is no more than the maximum it holds as it is.
  EXPECT_EQ(device.held(Vec3(0, 30, 40)), device.actingForce());
  EXPECT_EQ(device.held(Vec3(0, 0, -8)), Vec3(0, 0, -8));
  EXPECT_EQ(device.held(Vec3(1, 2, 3)), Vec3(1, 2, 3));
}

TEST(SimulatedDevice, SaysItsLimits) {
  SimulatedDeviceParameters p;
  p.force_limit_N = 5;
  p.encoder_resolution_m = 1e-5;
  p.delay_ticks = 3;
  p.slew_limit_N_per_s = 700;
  const DeviceLimits limits = SimulatedDevice(p, rest(), 1000).limits();
  EXPECT_EQ(limits.force_limit_N, 5);
  EXPECT_EQ(limits.position_resolution_m, 1e-5);
  EXPECT_EQ(limits.force_delay_ticks, 3);
  EXPECT_EQ(limits.slew_limit_N_per_s, 700);
}

TEST(SimulatedDevice, Refuses) {
  const auto refused = [](SimulatedDeviceParameters p, double rate_hz) {
    EXPECT_THROW(SimulatedDevice(p, rest(), rate_hz), Error);
  };
  SimulatedDeviceParameters p;
  refused(p, 0);
  p.delay_ticks = -1;
  refused(p, 1000);
  p = {};
  p.encoder_resolution_m = -1;
  refused(p, 1000);
  p = {};
  p.force_limit_N = 0;
  refused(p, 1000);
  p = {};
  p.slew_limit_N_per_s = -1;
  refused(p, 1000);
  p = {};
  p.delay_ticks = 10001;
  refused(p, 1000);
  p.delay_ticks = 10000;
  EXPECT_NO_THROW(SimulatedDevice(p, rest(), 1000));
}

// A dropped report leaves the last position, as old as it is; the same ones in each run, and about as many as asked
// for.
TEST(SimulatedDevice, DropsReports) {
  SimulatedDeviceParameters p;
  p.dropped_share = 0.3;
  std::vector<bool> dropped[2];
  for (auto& run : dropped) {
    SimulatedDevice device(p, ramp(), 1000);
    Vec3 before = Vec3::Zero();
    std::int64_t age_ticks = 0;
    for (int tick = 0; tick < 900; ++tick) {
      if (tick > 0) device.elapse(1);
      Vec3 now;
      ASSERT_TRUE(device.read(now));
      const bool is_new = now == ramp().position(tick / 1000.0);
      EXPECT_TRUE(is_new || now == before);
      age_ticks = is_new ? 0 : age_ticks + 1;
      EXPECT_EQ(device.reportAge_ns(), age_ticks * 1'000'000);
      run.push_back(!is_new);
      before = now;
    }
    EXPECT_NEAR(static_cast<double>(std::count(run.begin(), run.end(), true)), 270, 60);
  }
  EXPECT_EQ(dropped[0], dropped[1]);
  EXPECT_FALSE(dropped[0][0]);
}

}  // namespace simulated_device_test
}  // namespace palpate
