// SPDX-License-Identifier: Apache-2.0
#include "apps/stability/stiff_trial.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "apps/bench/random.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

struct Mode {
  double growth_per_s, hz;
};

Mode fastestMode(const StiffTrial& trial, double gain) {
  const std::complex<double> value =
      greatestEigenvalue(trial.loop, {gain * trial.wall.stiffness_N_per_m, gain * trial.wall.damping_Ns_per_m});
  return {std::log(std::abs(value)) * trial.loop.rate_hz, std::abs(std::arg(value)) * trial.loop.rate_hz / (2 * M_PI)};
}

// Loses at least 15 % of a swing a period, and is over within the trial.
bool dies(const Mode& mode) {
  return mode.growth_per_s < -std::max(1.0, 0.15 * mode.hz);
}

// Grows by e^3 a second, in swings that come often enough in a trial.
bool lives(const Mode& mode) {
  return mode.growth_per_s > 3 && mode.hz > 8;
}

constexpr std::uint32_t kLimited = bit(ServoFault::kForceLimited) | bit(ServoFault::kSlewLimited);

LoopParameters loopOf(const StiffTrial& trial) {
  LoopParameters loop;
  loop.rate_hz = trial.loop.rate_hz;
  loop.velocity.cutoff_hz = trial.loop.velocity_cutoff_hz;
  loop.safety.stale_window_s = 1e6;
  return loop;
}

}  // namespace

StiffTrial stiffTrial(std::uint64_t seed, std::uint64_t number) {
  Random random(seed * 1'000'003 + number);
  const auto decades = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  StiffTrial trial;
  trial.loop.hand = {.hand_mass_kg = decades(0.02, 0.5),
                     .hand_damping_Ns_per_m = decades(0.5, 20),
                     .hand_stiffness_N_per_m = decades(100, 2000),
                     .device_mass_kg = decades(0.01, 10),
                     .device_damping_Ns_per_m = decades(0.02, 5)};
  trial.loop.rate_hz = 1 / decades(50e-6, 10e-3);
  trial.loop.delay_ticks = random.uniform() < 0.5 ? 0 : static_cast<int>(random.uniform(0, 5));
  trial.wall.stiffness_N_per_m = decades(10, 1e6);
  if (random.uniform() < 0.6)
    trial.wall.damping_Ns_per_m = random.uniform(0, 1.2) * dampingBound(trial.loop, kSoftest_N_per_m);
  // Encoders of which a step changes the force by less than a newton; what is coarser, `palpate touch` tells.
  const double step_N_per_m = trial.wall.stiffness_N_per_m + trial.wall.damping_Ns_per_m * trial.loop.rate_hz;
  const double coarsest_m = std::min(50e-6, 1 / step_N_per_m);
  trial.resolution_m = random.uniform() < 0.5 ? 0 : random.uniform(0.1, 1) * coarsest_m;
  trial.press_m = random.uniform(0.3e-3, 3e-3);
  return trial;
}

Expected expectedOf(const StiffTrial& trial) {
  const bool encoders = trial.resolution_m > 0;
  if (dies(fastestMode(trial, 1)) && (!encoders || dies(fastestMode(trial, 4 / M_PI)))) return Expected::kSettles;
  return lives(fastestMode(trial, encoders ? 0.8 : 1)) ? Expected::kGrows : Expected::kBorder;
}

StiffOutcome play(const StiffTrial& trial, const WallVolume& plane) {
  WallRun run;
  run.contact.wall = trial.wall;
  run.device.hand = Hand::kSpring;
  run.device.dynamics = trial.loop.hand;
  run.device.delay_ticks = trial.loop.delay_ticks;
  run.device.encoder_resolution_m = trial.resolution_m;
  run.loop = loopOf(trial);
  run.loop.instability.doubtful = !settlesSoon(trial.loop, trial.wall);  // as a rig sets it
  run.seconds = kTrial_s;
  run.hand_W = [&](double time_s) {
    return Vec3(0, 0, 1e-3 - (1e-3 + trial.press_m) * std::clamp(time_s / 0.3, 0.0, 1.0));
  };
  StiffOutcome outcome;
  const double limit_N = std::min(run.device.force_limit_N, run.loop.safety.force_limit_N);
  const double slew_N = run.loop.safety.slew_limit_N_per_s / trial.loop.rate_hz;
  double first_contact_s = -1;
  double low_m = INFINITY, high_m = -INFINITY;
  Vec3 last_W = Vec3::Zero();
  for (const TickRecord& record : play(run, plane)) {
    const Vec3 force_W = asVec3(record.force_W);
    outcome.finite = outcome.finite && force_W.allFinite() && asVec3(record.hip_W).allFinite() &&
                     asVec3(record.vhip_W).allFinite() && std::isfinite(record.energy_J);
    outcome.force_share_max = std::max(outcome.force_share_max, force_W.norm() / limit_N);
    outcome.slew_share_max = std::max(outcome.slew_share_max, (force_W - last_W).norm() / slew_N);
    last_W = force_W;
    if (first_contact_s < 0 && record.in_contact) first_contact_s = record.time_s;
    if (!outcome.noticed && has(record.faults, ServoFault::kUnstable)) {
      outcome.noticed = true;
      outcome.notice_s = record.time_s - first_contact_s;
    }
    if (!outcome.noticed && (record.faults & kLimited) != 0) outcome.limited = true;
    if (record.time_s < 0.9 * kTrial_s) continue;
    outcome.end_force_N = std::max(outcome.end_force_N, force_W.norm());
    low_m = std::min(low_m, record.hip_W[2]);
    high_m = std::max(high_m, record.hip_W[2]);
  }
  outcome.end_swing_m = high_m - low_m;
  return outcome;
}

const char* name(Expected expected) noexcept {
  switch (expected) {
    case Expected::kSettles:
      return "settles";
    case Expected::kGrows:
      return "grows";
    default:
      return "border";
  }
}

}  // namespace palpate
