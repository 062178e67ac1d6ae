// SPDX-License-Identifier: Apache-2.0
// The passivity observer and controller in the loop, against a simulated device whose own state is the truth.
#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "servo/devices/path.hpp"
#include "servo/devices/simulated_device.hpp"
#include "servo/loop/run_figures.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/loop/velocity_filter.hpp"

namespace palpate {
namespace loop_energy_test {

constexpr double kStiffness = 2000;  // of the wall x < 0 [N/m]
constexpr double kRate_hz = 1000;

class Wall final : public Algorithm {
 public:
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W.cwiseMax(Vec3(0, -1, -1));
    out.force_W = kStiffness * (out.vhip_W - in.hip_W);
    out.in_contact = in.hip_W.x() < 0;
  }
};

// A hand of 0.1 kg pulls the device 0.8 mm into the wall. All friction together, 0.3 N s/m, is below K T / 2 = 1 N s/m:
// the tool does not come to rest by itself.
LoopResult pressOnWall(bool control, int delay_ticks, double encoder_m = 0) {
  const SampledPath path({0, 0.1, 3}, {Vec3(5e-3, 0, 0), Vec3(-5e-3, 0, 0), Vec3(-5e-3, 1e-3, 0)},
                         SampledPath::Interpolation::kLinear);
  SimulatedDeviceParameters d;
  d.hand = Hand::kSpring;
  d.dynamics.hand_mass_kg = 0.1;
  d.dynamics.device_mass_kg = 0.05;
  d.dynamics.hand_stiffness_N_per_m = 400;
  d.dynamics.hand_damping_Ns_per_m = 0.2;
  d.dynamics.device_damping_Ns_per_m = 0.1;
  d.delay_ticks = delay_ticks;
  d.encoder_resolution_m = encoder_m;
  SimulatedDevice device(d, path, kRate_hz);
  Wall wall;
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.ticks = 3000;
  p.passivity.control = control;
  p.instability.act = false;
  ServoLoop loop(p, wall, device, windows, tool);
  return loop.runSimulated();
}

// The force of a tick, held from `delay` ticks later on until the next, times the way meanwhile.
TEST(LoopEnergy, IsTheWorkOfTheForcesThatActed) {
  for (const int delay : {0, 3}) {
    const LoopResult run = pressOnWall(false, delay);
    double taken_J = 0, sum_J = 0;
    for (std::size_t k = 0; k < run.records.size(); ++k) {
      const TickRecord& now = run.records[k];
      const std::size_t held = k - 1 - static_cast<std::size_t>(delay);
      if (k >= 1 + static_cast<std::size_t>(delay)) {
        const double work_J = run.records[held].force_W[0] * (now.hip_W[0] - run.records[k - 1].hip_W[0]);
        taken_J -= work_J;
        sum_J += std::abs(work_J);
      }
      ASSERT_NEAR(now.energy_J, taken_J, 1e4 * std::numeric_limits<double>::epsilon() * sum_J) << k;
    }
    EXPECT_LT(taken_J, 0);
  }
}

double greatestWay(const LoopResult& run) {
  double way_m = 0;
  for (std::size_t k = 1; k < run.records.size(); ++k) {
    way_m = std::max(way_m, std::abs(run.records[k].hip_W[0] - run.records[k - 1].hip_W[0]));
  }
  return way_m;
}

// How far the tool still swings in the last half second.
double lastSwing(const LoopResult& run) {
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (std::size_t k = 2500; k < 3000; ++k) {
    low_m = std::min(low_m, run.records[k].hip_W[0]);
    high_m = std::max(high_m, run.records[k].hip_W[0]);
  }
  return high_m - low_m;
}

// Half a contact's leak, K a^2 pi / (4 w T), has to be back when the wall holds no energy any more: a deficit of at
// most K a^2 (sqrt(pi / (2 w T)) + 1 / 2) a tick (passivity_test.cpp; a the longest way in a tick, w that of wall and
// hand on both masses). Here the controller's velocity is the filter's, late by half a tick and 1 / (2 pi 200 Hz): in
// all, three ticks' deficits may be open. The device's encoders, a micrometre, are far below a, 0.2 mm.
TEST(LoopEnergy, TheControllerBringsAnActiveWallToRest) {
  const double frequency_rad_per_s = std::sqrt((kStiffness + 400) / 0.15);
  for (const double encoder_m : {0.0, 1e-6}) {
    const LoopResult free = pressOnWall(false, 0, encoder_m);
    const LoopResult controlled = pressOnWall(true, 0, encoder_m);
    const double way_m = greatestWay(controlled);
    const double bound_J =
        3 * kStiffness * way_m * way_m * (std::sqrt(M_PI * kRate_hz / (2 * frequency_rad_per_s)) + 0.5);
    const RunFigures figures = computeFigures(controlled.records, kRate_hz);
    EXPECT_GE(figures.energy_min_J, -bound_J);
    EXPECT_LT(computeFigures(free.records, kRate_hz).energy_min_J, -10 * bound_J);  // it had something to bring back
    EXPECT_GT(figures.damped_ticks, 0);
    EXPECT_LT(lastSwing(controlled), 0.1 * lastSwing(free));
  }
}

// What the controller adds is its damper times the filter's velocity. The damper is a quarter of what brakes the mass,
// 0.25 * 0.15 / (1 / 1000 + 1 / (2 pi 200)), or what answers a step of the encoders by 3 * 0.04 N.
TEST(LoopEnergy, TheControllersDamperIsNoMoreThanMassAndEncodersBear) {
  constexpr double kBrakes = 0.25 * 0.15 / (1e-3 + 1 / (2 * M_PI * 200));
  for (const double encoder_m : {0.0, 1e-6, 50e-6}) {
    const LoopResult run = pressOnWall(true, 0, encoder_m);
    VelocityFilter step(200, kRate_hz), filter(200, kRate_hz);
    step.reset(Vec3::Zero());
    const double step_m_per_s = step.update({encoder_m, 0, 0}, 1).x();
    const double most = encoder_m > 0 ? std::min(kBrakes, 3 * 0.04 / step_m_per_s) : kBrakes;
    filter.reset(Vec3(run.records[0].hip_W[0], 0, 0));
    double greatest = 0;
    for (std::size_t k = 1; k < run.records.size(); ++k) {
      const double x_m = run.records[k].hip_W[0];
      const double velocity_m_per_s = filter.update(Vec3(x_m, 0, 0), 1).x();
      const double added_N = run.records[k].force_W[0] - kStiffness * std::max(0.0, -x_m);
      if (std::abs(velocity_m_per_s) > 1e-3) greatest = std::max(greatest, std::abs(added_N / velocity_m_per_s));
    }
    EXPECT_LT(greatest, most * (1 + 1e-6)) << encoder_m;
    EXPECT_GT(greatest, 0.9 * most) << encoder_m;
  }
}

}  // namespace loop_energy_test
}  // namespace palpate
