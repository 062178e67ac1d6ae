// SPDX-License-Identifier: Apache-2.0
// tests/servo/loop/wall_trials.hpp: runs of the loop against a surface that is a formula, and what the eigenvalues of
// the sampled loop say of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <vector>

#include "servo/devices/simulated_device.hpp"
#include "servo/loop/contact_stability.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/stability/sampled_loop.hpp"
#include "wanted_path.hpp"

namespace palpate {

// Any surface z = height(x), pushed out of along its normal as the algorithms do it: K depth - B v, never pulling.
struct Ground {
  std::function<double(double x_m)> height = [](double) { return 0.0; };  // [m]
};

class GroundAlgorithm final : public Algorithm {
 public:
  GroundAlgorithm(Ground ground, double stiffness_N_per_m, double damping_Ns_per_m)
      : ground_(std::move(ground)), stiffness_(stiffness_N_per_m), damping_(damping_Ns_per_m) {}
  void reset(const Vec3&) noexcept override {}
  void tick(const TickInput& in, TickOutput& out) noexcept override {
    out = TickOutput{};
    out.vhip_W = in.hip_W;
    // To first order in the slope, which is at most 0.3: depth along the normal and the normal itself.
    const double x_m = in.hip_W.x(), slope = (ground_.height(x_m + kDx_m) - ground_.height(x_m - kDx_m)) / (2 * kDx_m);
    const Vec3 normal_W = Vec3(std::abs(slope) < 1 ? -slope : 0, 0, 1).normalized();  // not over an edge
    const double depth_m = (ground_.height(x_m) - in.hip_W.z()) * normal_W.z();
    if (depth_m <= 0) return;
    out.vhip_W += depth_m * normal_W;
    out.depth_m = depth_m;
    out.normal_W = normal_W;
    out.force_W = std::max(0.0, stiffness_ * depth_m - damping_ * in.hip_velocity_W.dot(normal_W)) * normal_W;
    out.in_contact = true;
  }

 private:
  static constexpr double kDx_m = 1e-6;

  Ground ground_;
  double stiffness_, damping_;
};

struct Trial {
  double stiffness_N_per_m = 500, damping_Ns_per_m = 0.5, rate_hz = 1000, seconds = 3;
  double slew_limit_N_per_s = 1e7;
  SimulatedDeviceParameters device;
  Ground ground;
  std::function<Vec3(double)> path;
  bool control = false;
  bool path_known = true;
  bool guarded = false;  // the loop ends unstable contacts
  bool doubtful = true;  // slow bounces too
};

// 1 mm above the surface, then down to `depth_m` within 0.3 s, and there.
inline std::function<Vec3(double)> press(double depth_m) {
  return [depth_m](double t_s) { return Vec3(0, 0, 1e-3 - (1e-3 + depth_m) * std::clamp(t_s / 0.3, 0.0, 1.0)); };
}

// `true_W`: if asked for, where the tool was in each tick, behind the encoders.
inline std::vector<TickRecord> recordsOf(const Trial& run, std::vector<Vec3>* true_W = nullptr) {
  const WantedPath path(run.path);
  SimulatedDevice device(run.device, path, run.rate_hz);
  GroundAlgorithm algorithm(run.ground, run.stiffness_N_per_m, run.damping_Ns_per_m);
  WindowStorage storage(8);
  WindowExchange windows(storage);
  ToolPoseMailbox tool;
  LoopParameters p;
  p.rate_hz = run.rate_hz;
  p.ticks = std::llround(run.seconds * run.rate_hz);
  p.safety.slew_limit_N_per_s = run.slew_limit_N_per_s;
  p.passivity.control = run.control;
  p.instability.act = run.guarded;
  p.instability.doubtful = run.doubtful;
  ServoLoop loop(p, algorithm, device, windows, tool);
  LoopResult result = loop.runSimulated([&](std::int64_t tick, std::int64_t) {
    if (true_W != nullptr && tick > 0) true_W->push_back(device.state().position_W);
  });
  return std::move(result.records);
}

inline ContactStability assess(const Trial& run) {
  const WantedPath path(run.path);
  return assessContact(recordsOf(run), {.resolution_m = run.device.encoder_resolution_m,
                                        .delay_ticks = run.device.delay_ticks,
                                        .path = run.path_known ? &path : nullptr});
}

// The loop in contact, without the unilateral surface. Its greatest eigenvalue says how it grows a tick, and turns.
inline std::complex<double> greatestEigenvalue(const Trial& run) {
  SampledLoop loop;
  loop.hand = run.device.dynamics;
  loop.rate_hz = run.rate_hz;
  loop.delay_ticks = run.device.delay_ticks;
  loop.velocity_cutoff_hz = VelocityParameters{}.cutoff_hz;
  return greatestEigenvalue(loop, {run.stiffness_N_per_m, run.damping_Ns_per_m});
}

struct Mode {
  double growth_per_s, hz;
};

// With the stiffness and damping that rounding makes of them: its describing function.
inline Mode fastestMode(Trial run, double gain) {
  run.stiffness_N_per_m *= gain;
  run.damping_Ns_per_m *= gain;
  const std::complex<double> value = greatestEigenvalue(run);
  return {std::log(std::abs(value)) * run.rate_hz, std::abs(std::arg(value)) * run.rate_hz / (2 * M_PI)};
}

// Loses 0.15 of a swing a period, 2.6 times what the criterion asks for, and settles within the run; so it does with
// the gain of rounding for swings of about a step too, which is up to 4 / pi.
constexpr double kLoss = 0.15;
inline bool settles(const Trial& run, double loss = kLoss) {
  const auto dies = [loss](Mode mode) { return mode.growth_per_s < -std::max(1.0, loss * mode.hz); };
  return dies(fastestMode(run, 1)) && (run.device.encoder_resolution_m == 0 || dies(fastestMode(run, 4 / M_PI)));
}

// Grown by 3 /s over the 2.7 s of the press, an error is e^8 times what it was: the press's own 0.1 mm swing is a limit
// cycle long before, and at 8 Hz there are 20 swings in a second and a quarter. With encoders, swings of three steps
// grow still: the gain is then 0.8.
inline bool grows(const Trial& run) {
  const Mode mode = fastestMode(run, run.device.encoder_resolution_m > 0 ? 0.8 : 1);
  return mode.growth_per_s > 3 && mode.hz > 8;
}

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double decades(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool coin() { return between(0, 1) < 0.5; }

 private:
  std::mt19937 random_;
};

}  // namespace palpate
