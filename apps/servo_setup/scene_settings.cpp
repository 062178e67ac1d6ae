// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/scene_settings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/scene/option_table.hpp"

namespace palpate {
namespace {

VelocityParameters velocityParameters(const Scene& scene) {
  VelocityParameters velocity;
  velocity.name = scene.velocity;
  velocity.cutoff_hz = scene.velocity_cutoff_hz;
  velocity.noise_m = scene.velocity_noise_m;
  return velocity;
}

}  // namespace

LoopParameters loopParameters(const Scene& scene) {
  LoopParameters loop;
  loop.rate_hz = scene.rate_hz;
  loop.require_real_time = scene.require_real_time;
  loop.ticks = std::llround(scene.duration_s * scene.rate_hz);
  loop.safety = {.force_limit_N = scene.force_limit_N,
                 .slew_limit_N_per_s = scene.slew_limit_N_per_s,
                 .fade_s = scene.fade_s,
                 .stale_window_s = scene.stale_window_s,
                 .stall_s = scene.stall_s,
                 .report_timeout_s = scene.report_timeout_s};
  loop.velocity = velocityParameters(scene);
  loop.passivity.control = scene.passivity_control;
  loop.instability.act = !scene.leave_shaking;
  return loop;
}

DeviceSetup deviceSetup(const Scene& scene, const Path& path) {
  const std::pair<const char*, double> asked[] = {{"spring_hand", scene.spring_hand ? 1 : 0},
                                                  {"hand_mass_kg", scene.hand_mass_kg},
                                                  {"hand_damping_Ns_per_m", scene.hand_damping_Ns_per_m},
                                                  {"hand_stiffness_N_per_m", scene.hand_stiffness_N_per_m},
                                                  {"mass_kg", scene.device_mass_kg},
                                                  {"damping_Ns_per_m", scene.device_damping_Ns_per_m},
                                                  {"encoder_resolution_m", scene.encoder_resolution_m},
                                                  {"friction_N", scene.device_friction_N},
                                                  {"dropped_share", scene.device_dropped_share},
                                                  {"delay_ticks", scene.device_delay_ticks}};
  DeviceSetup setup{.path = &path, .rate_hz = scene.rate_hz};
  for (const auto& [key, value] : asked) {
    if (value != deviceParameter(devices().front().name, key).usual) setup.values[key] = value;
  }
  // The safety gate keeps this limit too, so a scene may give it whatever the device.
  const auto parameters = deviceEntry(scene.device).parameters();
  if (std::ranges::any_of(parameters, [](const DeviceParameter& p) { return p.key == "force_limit_N"; }))
    setup.values["force_limit_N"] = scene.force_limit_N;
  return setup;
}

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
                                      .stiffness_N_per_m = stiffnessOf(scene),
                                      .damping_Ns_per_m = dampingOf(scene),
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

Scene withRigSettings(Scene scene, const RigSettings& settings) {
  const AlgorithmParameters& p = settings.parameters;
  scene.algorithm = settings.algorithm;
  scene.isovalue = p.isovalue;
  scene.stiffness_N_per_m = p.stiffness_N_per_m;
  scene.damping_Ns_per_m = p.damping_Ns_per_m;
  scene.plane_renewal_ticks = p.plane_renewal_ticks;
  scene.force_limit_N = settings.force_limit_N;
  const EffectParameters& e = settings.effects;
  scene.force_shading = e.force_shading;
  scene.recovery_s = e.recovery_s;
  scene.texture = nameOfTexture(e.texture);
  scene.texture_amplitude_m = e.texture_amplitude_m;
  scene.texture_wavelength_m = e.texture_wavelength_m;
  scene.texture_gain = e.texture_gain;
  scene.friction_static = e.friction.static_ratio;
  scene.friction_dynamic = e.friction.dynamic_ratio;
  scene.friction_viscous_Ns_per_m = e.friction.viscous_Ns_per_m;
  scene.stiffness_density.clear();
  for (const StiffnessRow& row : e.stiffness_by_density) scene.stiffness_density.push_back({row.density, row.factor});
  scene.haptization_density.clear();
  for (const DensityRow& row : settings.haptization.density)
    scene.haptization_density.push_back({row.density, row.force_N, row.viscosity_Ns_per_m});
  scene.haptization_gradient.clear();
  for (const GradientRow& row : settings.haptization.gradient)
    scene.haptization_gradient.push_back({row.gradient_per_m, row.weight});
  return scene;
}

RigSettings withChanges(const RigSettings& present, const RigSettings& before, const RigSettings& wanted) {
  const Scene from = withRigSettings({}, before), to = withRigSettings({}, wanted);
  Scene scene = withRigSettings({}, present);
  for (const SceneOption& option : sceneOptions()) {
    if (!isSame(option.value, from, to)) copyOption(option.value, to, scene);
  }
  RigSettings settings = rigSettings(scene, *scene.isovalue);
  settings.parameters.rate_hz = present.parameters.rate_hz;
  return settings;
}

double lackingDamping(const Scene& scene, const DeviceLimits& device) {
  if (!algorithmEntry(scene.algorithm).traits.shows_surface) return 0;
  const double factor = mostStiffening(effectParameters(scene));
  const double needed_Ns_per_m = stiffnessOf(scene) * factor * (0.5 + device.force_delay_ticks) / scene.rate_hz;
  return std::max(0.0, needed_Ns_per_m - dampingOf(scene));
}

}  // namespace palpate
