// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/hand_dynamics.hpp"

#include <algorithm>
#include <cmath>

#include <unsupported/Eigen/MatrixFunctions>

#include "base/error.hpp"
#include "servo/devices/hand_friction.hpp"

namespace palpate {

double quietJump(const HandParameters& hand) noexcept {
  constexpr double kLeastFriction_N = 0.02;
  return 2 * std::max(hand.device_friction_N, kLeastFriction_N);
}

double brakingDamping(const HandParameters& hand, double rate_hz, int delay_ticks, double velocity_cutoff_hz) noexcept {
  const double filter_s = velocity_cutoff_hz > 0 ? 1 / (2 * M_PI * velocity_cutoff_hz) : 0;
  return (hand.hand_mass_kg + hand.device_mass_kg) / ((1 + delay_ticks) / rate_hz + filter_s);
}

HandDynamics::HandDynamics(const HandParameters& p, double tick_s) : tick_s_(tick_s), parameters_(p) {
  checkSetting(p.hand_mass_kg >= 0, "hand mass", p.hand_mass_kg, "give 0 kg or more");
  checkSetting(p.device_mass_kg >= 0, "device mass", p.device_mass_kg, "give 0 kg or more");
  checkSetting(p.hand_damping_Ns_per_m >= 0, "hand damping", p.hand_damping_Ns_per_m, "give 0 N s/m or more");
  checkSetting(p.device_damping_Ns_per_m >= 0, "device damping", p.device_damping_Ns_per_m, "give 0 N s/m or more");
  checkSetting(p.hand_stiffness_N_per_m >= 0, "hand stiffness", p.hand_stiffness_N_per_m, "give 0 N/m or more");
  checkSetting(p.device_friction_N >= 0 && std::isfinite(p.device_friction_N), "device friction", p.device_friction_N,
               "give 0 N or more");
  const double mass_kg = p.hand_mass_kg + p.device_mass_kg;
  checkSetting(mass_kg > 0, "mass of hand and device", mass_kg, "give one of them more than 0 kg");
  checkSetting(tick_s > 0, "tick", tick_s, "give a positive time in s");

  // States x, x', r, r', F; the last two are constant over a tick.
  Eigen::Matrix<double, 5, 5> rate = Eigen::Matrix<double, 5, 5>::Zero();  // [1/s]
  rate(0, 1) = 1;
  rate.row(1) << -p.hand_stiffness_N_per_m, -p.hand_damping_Ns_per_m - p.device_damping_Ns_per_m,
      p.hand_stiffness_N_per_m, p.hand_damping_Ns_per_m, 1;
  rate.row(1) /= mass_kg;
  rate(2, 3) = 1;
  const Eigen::Matrix<double, 5, 5> over_tick = (rate * tick_s).exp();
  transition_ = over_tick.topRows<2>();
}

HandDynamics::State HandDynamics::step(const State& state, const Vec3& path_start_W, const Vec3& path_end_W,
                                       const Vec3& force_W) const noexcept {
  const Vec3 slope_W = (path_end_W - path_start_W) / tick_s_;
  if (parameters_.device_friction_N > 0) {
    State next;
    for (int axis = 0; axis < 3; ++axis) {
      const FrictionAxis moved = stepWithFriction(parameters_, {state.position_W[axis], state.velocity_W[axis]},
                                                  {path_start_W[axis], slope_W[axis]}, force_W[axis], tick_s_);
      next.position_W[axis] = moved.position_m;
      next.velocity_W[axis] = moved.velocity_m_per_s;
    }
    return next;
  }
  const auto row = [&](int i) {
    return Vec3(transition_(i, 0) * state.position_W + transition_(i, 1) * state.velocity_W +
                transition_(i, 2) * path_start_W + transition_(i, 3) * slope_W + transition_(i, 4) * force_W);
  };
  return {row(0), row(1)};
}

}  // namespace palpate
