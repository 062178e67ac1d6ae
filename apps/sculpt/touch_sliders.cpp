// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/touch_sliders.hpp"

namespace palpate {
namespace {

double& sticks(RigSettings& s) {
  return s.effects.friction.static_ratio;
}
double& slips(RigSettings& s) {
  return s.effects.friction.dynamic_ratio;
}

constexpr double kMilli = 1e-3;

const TouchSlider kSliders[] = {
    {"Stiffness", "servo.stiffness_N_per_m", [](RigSettings& s) -> double& { return s.parameters.stiffness_N_per_m; },
     20, 3000, 1, "%.0f N/m", true},
    {"Damping", "servo.damping_Ns_per_m", [](RigSettings& s) -> double& { return s.parameters.damping_Ns_per_m; }, 0, 5,
     1, "%.2f N s/m"},
    {"Friction", "contact.friction_static", sticks, 0, 1.2, 1, "%.2f", false, slips},
    {"Sliding", "contact.friction_dynamic", slips, 0, 1.2, 1, "%.2f", false, nullptr, sticks},
    {"Recovery", "contact.recovery_ms", [](RigSettings& s) -> double& { return s.effects.recovery_s; }, 0, 0.1, kMilli,
     "%.0f ms"},
    {"Force limit", "safety.force_limit_N", [](RigSettings& s) -> double& { return s.force_limit_N; }, 0.5, 8, 1,
     "%.1f N"},
};

}  // namespace

std::span<const TouchSlider> touchSliders() {
  return kSliders;
}

}  // namespace palpate
