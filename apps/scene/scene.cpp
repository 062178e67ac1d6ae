// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene.hpp"

#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/devices/registry.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

std::string defaultAlgorithm() {
  return std::string(algorithms().front().name);
}

std::string defaultDevice() {
  return std::string(devices().front().name);
}

double usualOfDevice(std::string_view key) {
  return deviceParameter(devices().front().name, key).usual;
}

const ServoDefaults& servoDefaults() noexcept {
  static const LoopParameters kLoop;
  static const AlgorithmParameters kAlgorithm;
  static const EffectParameters kEffects;
  static const ServoDefaults kDefaults{.rate_hz = kLoop.rate_hz,
                                       .stiffness_N_per_m = kAlgorithm.stiffness_N_per_m,
                                       .damping_Ns_per_m = kAlgorithm.damping_Ns_per_m,
                                       .plane_renewal_ticks = kAlgorithm.plane_renewal_ticks,
                                       .velocity = kLoop.velocity.name,
                                       .velocity_cutoff_hz = kLoop.velocity.cutoff_hz,
                                       .force_limit_N = kLoop.safety.force_limit_N,
                                       .slew_limit_N_per_s = kLoop.safety.slew_limit_N_per_s,
                                       .fade_s = kLoop.safety.fade_s,
                                       .stale_window_s = kLoop.safety.stale_window_s,
                                       .stall_s = kLoop.safety.stall_s,
                                       .report_timeout_s = kLoop.safety.report_timeout_s,
                                       .recovery_s = kEffects.recovery_s,
                                       .texture_amplitude_m = kEffects.texture_amplitude_m,
                                       .texture_wavelength_m = kEffects.texture_wavelength_m,
                                       .texture_gain = kEffects.texture_gain,
                                       .friction_static = kEffects.friction.static_ratio,
                                       .friction_dynamic = kEffects.friction.dynamic_ratio,
                                       .friction_viscous_Ns_per_m = kEffects.friction.viscous_Ns_per_m};
  return kDefaults;
}

}  // namespace palpate
