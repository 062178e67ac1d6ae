// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/rig_settings.hpp"

#include <algorithm>

#include "servo/contact/effects.hpp"

namespace palpate {

EffectParameters effectParameters(const Scene& scene) {
  std::vector<StiffnessRow> stiffness_rows;
  for (const std::vector<double>& row : scene.stiffness_density) stiffness_rows.push_back({row.at(0), row.at(1)});
  return {.force_shading = scene.force_shading,
          .recovery_s = scene.recovery_s,
          .texture = textureOfName(scene.texture),
          .texture_amplitude_m = scene.texture_amplitude_m,
          .texture_wavelength_m = scene.texture_wavelength_m,
          .texture_gain = scene.texture_gain,
          .friction = {.static_ratio = scene.friction_static,
                       .dynamic_ratio = scene.friction_dynamic,
                       .viscous_Ns_per_m = scene.friction_viscous_Ns_per_m},
          .stiffness_by_density = std::move(stiffness_rows)};
}

RigSettings rigSettings(const Scene& scene, double isovalue) {
  RigSettings settings{.algorithm = scene.algorithm,
                       .parameters = {.isovalue = isovalue,
                                      .stiffness_N_per_m = scene.stiffness_N_per_m,
                                      .damping_Ns_per_m = scene.damping_Ns_per_m,
                                      .plane_renewal_ticks = scene.plane_renewal_ticks,
                                      .rate_hz = scene.rate_hz},
                       .effects = effectParameters(scene),
                       .force_limit_N = scene.force_limit_N};
  for (const std::vector<double>& row : scene.haptization_density) {
    settings.haptization.density.push_back({row.at(0), row.at(1), row.at(2)});
  }
  for (const std::vector<double>& row : scene.haptization_gradient) {
    settings.haptization.gradient.push_back({row.at(0), row.at(1)});
  }
  return settings;
}

double lackingDamping(const Scene& scene) {
  if (!algorithmEntry(scene.algorithm).traits.shows_surface) return 0;
  double factor = scene.stiffness_density.empty() ? 1 : 0;
  for (const std::vector<double>& row : scene.stiffness_density) factor = std::max(factor, row.at(1));
  const double needed_Ns_per_m = scene.stiffness_N_per_m * factor * (0.5 + scene.device_delay_ticks) / scene.rate_hz;
  return std::max(0.0, needed_Ns_per_m - scene.damping_Ns_per_m);
}

}  // namespace palpate
