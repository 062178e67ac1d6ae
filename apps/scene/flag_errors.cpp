// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/flag_errors.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "apps/scene/option_table.hpp"

namespace palpate {
namespace {

struct ServoName {
  const char* name;  // the servo's name, which is the input of its errors
  const char* key;
};

constexpr ServoName kServoNames[] = {
    {"rate", "servo.rate_hz"},
    {"stiffness", "servo.stiffness_N_per_m"},
    {"damping", "servo.damping_Ns_per_m"},
    {"plane renewal", "servo.n"},
    {"velocity cutoff", "servo.velocity_cutoff_hz"},
    {"velocity noise bound", "servo.velocity_noise_mm"},
    {"haptization density", "haptization.density"},
    {"haptization gradient", "haptization.gradient"},
    {"force limit", "safety.force_limit_N"},
    {"device force limit", "safety.force_limit_N"},
    {"slew limit", "safety.slew_limit_N_per_s"},
    {"fade time", "safety.fade_s"},
    {"stale window time", "safety.stale_window_s"},
    {"stall time", "safety.stall_s"},
    {"report timeout", "safety.report_timeout_s"},
    {"recovery time", "contact.recovery_ms"},
    {"texture amplitude", "contact.texture_amplitude_mm"},
    {"texture wavelength", "contact.texture_wavelength_mm"},
    {"texture gain", "contact.texture_gain"},
    {"static friction", "contact.friction_static"},
    {"dynamic friction", "contact.friction_dynamic"},
    {"viscous friction", "contact.friction_viscous_Ns_per_m"},
    {"stiffness by density", "contact.stiffness_density"},
    {"hand mass", "hand.mass_kg"},
    {"hand damping", "hand.damping_Ns_per_m"},
    {"hand stiffness", "hand.stiffness_N_per_m"},
    {"device mass", "device.mass_kg"},
    {"device damping", "device.damping_Ns_per_m"},
    {"encoder resolution", "device.encoder_resolution_mm"},
    {"device delay", "device.delay_ticks"},
};

}  // namespace

Error withFlag(const Error& error) {
  const auto* row = std::find_if(std::begin(kServoNames), std::end(kServoNames),
                                 [&](const ServoName& known) { return error.input() == known.name; });
  if (error.code() != Error::Code::kBadInput || row == std::end(kServoNames)) return error;
  const SceneOption& option = *optionOfKey(row->key);
  return {error.code(), fmt::format("{} (key {})", option.flag, option.key), error.reason(), error.remedy()};
}

}  // namespace palpate
