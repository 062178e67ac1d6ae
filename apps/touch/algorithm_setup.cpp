// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/algorithm_setup.hpp"

#include "servo/contact/effects.hpp"

namespace palpate {
namespace {

EffectParameters effectParameters(const Scene& scene) {
  return {.force_shading = scene.force_shading,
          .recovery_s = scene.recovery_s,
          .texture = textureOfName(scene.texture),
          .texture_amplitude_m = scene.texture_amplitude_m,
          .texture_wavelength_m = scene.texture_wavelength_m,
          .texture_gain = scene.texture_gain,
          .friction = {.static_ratio = scene.friction_static,
                       .dynamic_ratio = scene.friction_dynamic,
                       .viscous_Ns_per_m = scene.friction_viscous_Ns_per_m},
          .stiffness_by_density = parseStiffnessRows(scene.stiffness_density)};
}

}  // namespace

AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue) {
  AlgorithmSetup setup;
  setup.parameters = {.isovalue = isovalue,
                      .stiffness_N_per_m = scene.stiffness_N_per_m,
                      .damping_Ns_per_m = scene.damping_Ns_per_m,
                      .plane_renewal_ticks = scene.plane_renewal_ticks};
  setup.effects = makeContactEffects(effectParameters(scene), scene.stiffness_N_per_m, scene.rate_hz);
  return setup;
}

}  // namespace palpate
