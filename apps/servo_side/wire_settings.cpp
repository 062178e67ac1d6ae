// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/wire_settings.hpp"

#include <cmath>

#include <fmt/format.h>

#include "base/formatted.hpp"
#include "base/other_version.hpp"

namespace palpate {
namespace {

using Rows = std::vector<std::unique_ptr<wire::RowT>>;

void addRow(Rows& rows, std::vector<double> values) {
  rows.push_back(std::make_unique<wire::RowT>());
  rows.back()->values = std::move(values);
}

// The values of each row, `columns` of them.
std::vector<std::vector<double>> tableOf(const Rows& rows, std::size_t columns, const char* name) {
  std::vector<std::vector<double>> table;
  for (const auto& row : rows) {
    if (!row || row->values.size() != columns)
      refuseOtherVersion(name, fmt::format("a row has not {} values", columns));
    table.push_back(row->values);
  }
  return table;
}

TextureKind textureOf(std::uint8_t wire) {
  if (wire > static_cast<std::uint8_t>(TextureKind::kDensity))
    refuseOtherVersion(fmt::format("texture {}", wire), "this program does not know it");
  return static_cast<TextureKind>(wire);
}

}  // namespace

std::unique_ptr<wire::SettingsT> wireOf(const RigSettings& settings) {
  auto wire = std::make_unique<wire::SettingsT>();
  const AlgorithmParameters& p = settings.parameters;
  const EffectParameters& e = settings.effects;
  wire->algorithm = settings.algorithm;
  wire->isovalue = p.isovalue;
  wire->stiffness_N_per_m = p.stiffness_N_per_m;
  wire->damping_Ns_per_m = p.damping_Ns_per_m;
  wire->plane_renewal_ticks = p.plane_renewal_ticks;
  wire->rate_hz = p.rate_hz;
  wire->force_limit_N = settings.force_limit_N;
  for (const DensityRow& row : settings.haptization.density)
    addRow(wire->haptization_density, {row.density, row.force_N, row.viscosity_Ns_per_m});
  for (const GradientRow& row : settings.haptization.gradient)
    addRow(wire->haptization_gradient, {row.gradient_per_m, row.weight});
  wire->force_shading = e.force_shading;
  wire->recovery_s = e.recovery_s;
  wire->texture = static_cast<std::uint8_t>(e.texture);
  wire->texture_amplitude_m = e.texture_amplitude_m;
  wire->texture_wavelength_m = e.texture_wavelength_m;
  wire->texture_gain = e.texture_gain;
  wire->friction_static = e.friction.static_ratio;
  wire->friction_dynamic = e.friction.dynamic_ratio;
  wire->friction_viscous_Ns_per_m = e.friction.viscous_Ns_per_m;
  for (const StiffnessRow& row : e.stiffness_by_density) addRow(wire->stiffness_density, {row.density, row.factor});
  return wire;
}

RigSettings settingsOf(const std::unique_ptr<wire::SettingsT>& wire) {
  if (!wire) refuseOtherVersion("settings", "a message has none");
  RigSettings settings;
  settings.algorithm = wire->algorithm;
  settings.parameters = {.isovalue = wire->isovalue,
                         .stiffness_N_per_m = wire->stiffness_N_per_m,
                         .damping_Ns_per_m = wire->damping_Ns_per_m,
                         .plane_renewal_ticks = wire->plane_renewal_ticks,
                         .rate_hz = wire->rate_hz};
  settings.force_limit_N = wire->force_limit_N;
  for (const auto& row : tableOf(wire->haptization_density, 3, "haptization by density"))
    settings.haptization.density.push_back({row[0], row[1], row[2]});
  for (const auto& row : tableOf(wire->haptization_gradient, 2, "haptization by gradient"))
    settings.haptization.gradient.push_back({row[0], row[1]});
  settings.effects = {.force_shading = wire->force_shading,
                      .recovery_s = wire->recovery_s,
                      .texture = textureOf(wire->texture),
                      .texture_amplitude_m = wire->texture_amplitude_m,
                      .texture_wavelength_m = wire->texture_wavelength_m,
                      .texture_gain = wire->texture_gain,
                      .friction = {.static_ratio = wire->friction_static,
                                   .dynamic_ratio = wire->friction_dynamic,
                                   .viscous_Ns_per_m = wire->friction_viscous_Ns_per_m}};
  for (const auto& row : tableOf(wire->stiffness_density, 2, "stiffness by density"))
    settings.effects.stiffness_by_density.push_back({row[0], row[1]});
  return settings;
}

std::unique_ptr<wire::VectorT> wireOf(const Vec3& v) {
  auto wire = std::make_unique<wire::VectorT>();
  wire->x = v.x();
  wire->y = v.y();
  wire->z = v.z();
  return wire;
}

Vec3 vectorOf(const std::unique_ptr<wire::VectorT>& wire) {
  return wire ? Vec3(wire->x, wire->y, wire->z) : Vec3(Vec3::Zero());
}

wire::DeviceMadeT wireOf(const Device& device) {
  const DeviceLimits limits = device.limits();
  wire::DeviceMadeT wire;
  wire.name = device.name();
  wire.force_limit_N = limits.force_limit_N;
  wire.motors_unchecked = limits.motors_unchecked;
  wire.position_resolution_m = limits.position_resolution_m;
  wire.force_delay_ticks = limits.force_delay_ticks;
  wire.slew_limit_N_per_s = limits.slew_limit_N_per_s;
  wire.follows_force = limits.follows_force;
  wire.sets_pace = limits.sets_pace;
  wire.stiffness_limit_N_per_m = limits.stiffness_limit_N_per_m;
  wire.workspace_radius_m = limits.workspace_radius_m;
  wire.is_held = limits.is_held;
  wire.motion_speed_m_per_s = limits.motion.speed_m_per_s;
  wire.motion_acceleration_m_per_s2 = limits.motion.acceleration_m_per_s2;
  for (const HandParameters& hand : device.hands()) {
    wire.hands.push_back(std::make_unique<wire::HandT>());
    wire::HandT& to = *wire.hands.back();
    to.hand_mass_kg = hand.hand_mass_kg;
    to.hand_damping_Ns_per_m = hand.hand_damping_Ns_per_m;
    to.hand_stiffness_N_per_m = hand.hand_stiffness_N_per_m;
    to.device_mass_kg = hand.device_mass_kg;
    to.device_damping_Ns_per_m = hand.device_damping_Ns_per_m;
    to.device_friction_N = hand.device_friction_N;
  }
  wire.force_off = static_cast<std::uint8_t>(device.forceOff());
  return wire;
}

DeviceLimits limitsOf(const wire::DeviceMadeT& wire) {
  constexpr int kMostDelay_ticks = 1000;
  if (wire.force_delay_ticks < 0 || wire.force_delay_ticks > kMostDelay_ticks) {
    refuseOtherVersion("the servo's device",
                       formatted("its force is late by {} ticks, which none is", wire.force_delay_ticks));
  }
  return {.force_limit_N = wire.force_limit_N,
          .motors_unchecked = wire.motors_unchecked,
          .position_resolution_m = wire.position_resolution_m,
          .force_delay_ticks = wire.force_delay_ticks,
          .slew_limit_N_per_s = wire.slew_limit_N_per_s,
          .sets_pace = wire.sets_pace,
          .follows_force = wire.follows_force,
          .stiffness_limit_N_per_m = wire.stiffness_limit_N_per_m,
          .workspace_radius_m = wire.workspace_radius_m,
          .is_held = wire.is_held,
          .motion = {.speed_m_per_s = wire.motion_speed_m_per_s,
                     .acceleration_m_per_s2 = wire.motion_acceleration_m_per_s2}};
}

std::vector<HandParameters> handsOf(const wire::DeviceMadeT& wire) {
  constexpr std::size_t kMostHands = 8;  // for each the loop's stability is computed
  if (wire.hands.size() > kMostHands)
    refuseOtherVersion("the servo's device",
                       fmt::format("it names {} hands, and may name {}", wire.hands.size(), kMostHands));
  std::vector<HandParameters> hands;
  for (const auto& hand : wire.hands) {
    if (!hand) continue;
    for (const double number : {hand->hand_mass_kg, hand->hand_damping_Ns_per_m, hand->hand_stiffness_N_per_m,
                                hand->device_mass_kg, hand->device_damping_Ns_per_m, hand->device_friction_N}) {
      if (!std::isfinite(number) || number < 0)
        refuseOtherVersion("the servo's device", fmt::format("a hand of it has {}", number));
    }
    hands.push_back({.hand_mass_kg = hand->hand_mass_kg,
                     .hand_damping_Ns_per_m = hand->hand_damping_Ns_per_m,
                     .hand_stiffness_N_per_m = hand->hand_stiffness_N_per_m,
                     .device_mass_kg = hand->device_mass_kg,
                     .device_damping_Ns_per_m = hand->device_damping_Ns_per_m,
                     .device_friction_N = hand->device_friction_N});
  }
  return hands;
}

ForceOff forceOffOf(std::uint8_t wire) noexcept {
  return wire <= static_cast<std::uint8_t>(ForceOff::kClutched) ? static_cast<ForceOff>(wire) : ForceOff::kDisconnected;
}

}  // namespace palpate
