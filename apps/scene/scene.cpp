// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene.hpp"

#include <algorithm>
#include <iterator>

#include "base/error.hpp"
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

double usualOfServo(std::string_view key) {
  struct Usual {
    std::string_view key;
    double value;
  };
  static const LoopParameters kLoop;
  static const AlgorithmParameters kAlgorithm;
  static const EffectParameters kEffects;
  static const Usual kUsual[] = {{"servo.n", static_cast<double>(kAlgorithm.plane_renewal_ticks)},
                                 {"servo.stiffness_N_per_m", kAlgorithm.stiffness_N_per_m},
                                 {"servo.damping_Ns_per_m", kAlgorithm.damping_Ns_per_m},
                                 {"servo.rate_hz", kLoop.rate_hz},
                                 {"servo.velocity_cutoff_hz", kLoop.velocity.cutoff_hz},
                                 {"safety.force_limit_N", kLoop.safety.force_limit_N},
                                 {"safety.slew_limit_N_per_s", kLoop.safety.slew_limit_N_per_s},
                                 {"safety.fade_s", kLoop.safety.fade_s},
                                 {"safety.stale_window_s", kLoop.safety.stale_window_s},
                                 {"safety.stall_s", kLoop.safety.stall_s},
                                 {"safety.report_timeout_s", kLoop.safety.report_timeout_s},
                                 {"contact.recovery_ms", kEffects.recovery_s},
                                 {"contact.texture_amplitude_mm", kEffects.texture_amplitude_m},
                                 {"contact.texture_wavelength_mm", kEffects.texture_wavelength_m},
                                 {"contact.texture_gain", kEffects.texture_gain},
                                 {"contact.friction_static", kEffects.friction.static_ratio},
                                 {"contact.friction_dynamic", kEffects.friction.dynamic_ratio},
                                 {"contact.friction_viscous_Ns_per_m", kEffects.friction.viscous_Ns_per_m}};
  const auto* const found = std::ranges::find(kUsual, key, &Usual::key);
  if (found == std::end(kUsual)) refuse(std::string(key), "the servo has no parameter of this key", "ask for another");
  return found->value;
}

}  // namespace palpate
