// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/effects.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/formatted.hpp"
#include "servo/contact/force_shading.hpp"
#include "servo/contact/recovery.hpp"
#include "servo/contact/stiffness_by_density.hpp"
#include "servo/contact/texture.hpp"

namespace palpate {
namespace {

void checkNotNegative(const char* input, double value) {
  checkSetting(value >= 0, input, value, "give 0 or more");
}

void checkParameters(const EffectParameters& p, double stiffness_N_per_m, double rate_hz) {
  checkNotNegative("stiffness", stiffness_N_per_m);
  checkSetting(rate_hz > 0, "rate", rate_hz, "give more than 0 Hz");
  checkNotNegative("recovery time", p.recovery_s);
  checkSetting(p.recovery_s * rate_hz <= kLongestRecovery, "recovery time", p.recovery_s, "give a shorter time");
  checkNotNegative("texture amplitude", p.texture_amplitude_m);
  checkSetting(p.texture_wavelength_m > 0, "texture wavelength", p.texture_wavelength_m, "give more than 0 mm");
  checkNotNegative("texture gain", p.texture_gain);
  checkNotNegative("static friction", p.friction.static_ratio);
  checkNotNegative("dynamic friction", p.friction.dynamic_ratio);
  checkNotNegative("viscous friction", p.friction.viscous_Ns_per_m);
  checkSetting(p.friction.dynamic_ratio <= p.friction.static_ratio, "dynamic friction", p.friction.dynamic_ratio,
               formatted("give at most the static friction, {}", p.friction.static_ratio).c_str());
}

// A recovery time below a tick is a tick: that is no recovery, but harmless.
int recoveryTicks(double recovery_s, double rate_hz) {
  return static_cast<int>(std::max(1.0, std::round(recovery_s * rate_hz)));
}

std::unique_ptr<ContactEffect> makeTexture(const EffectParameters& p, double rate_hz) {
  if (p.texture == TextureKind::kProcedural)
    return std::make_unique<ProceduralTexture>(p.texture_amplitude_m, p.texture_wavelength_m);
  return std::make_unique<DensityTexture>(p.texture_amplitude_m, p.texture_gain, rate_hz);
}

struct Contact {
  double stiffness_N_per_m;
  double rate_hz;
};

struct EffectRow {
  const char* name;
  bool (*asked)(const EffectParameters& p);
  std::unique_ptr<ContactEffect> (*make)(const EffectParameters& p, const Contact& contact);
};

// In the order in which they act.
constexpr EffectRow kEffects[] = {
    {"force shading", [](const EffectParameters& p) { return p.force_shading; },
     [](const EffectParameters&, const Contact&) -> std::unique_ptr<ContactEffect> {
       return std::make_unique<ForceShading>();
     }},
    {"recovery time", [](const EffectParameters& p) { return p.recovery_s > 0; },
     [](const EffectParameters& p, const Contact& c) -> std::unique_ptr<ContactEffect> {
       return std::make_unique<Recovery>(recoveryTicks(p.recovery_s, c.rate_hz));
     }},
    {"texture", [](const EffectParameters& p) { return p.texture != TextureKind::kNone; },
     [](const EffectParameters& p, const Contact& c) { return makeTexture(p, c.rate_hz); }},
    {"friction",
     [](const EffectParameters& p) { return p.friction.static_ratio > 0 || p.friction.viscous_Ns_per_m > 0; },
     [](const EffectParameters& p, const Contact& c) -> std::unique_ptr<ContactEffect> {
       return std::make_unique<Friction>(p.friction, c.stiffness_N_per_m, c.rate_hz);
     }},
    {"stiffness by density", [](const EffectParameters& p) { return !p.stiffness_by_density.empty(); },
     [](const EffectParameters& p, const Contact& c) -> std::unique_ptr<ContactEffect> {
       return std::make_unique<StiffnessByDensity>(StiffnessTable(p.stiffness_by_density), c.rate_hz);
     }},
};

constexpr std::string_view kTextureNames[] = {"none", "procedural", "density"};  // by TextureKind

}  // namespace

TextureKind textureOfName(std::string_view name) {
  const auto* const known = std::ranges::find(kTextureNames, name);
  if (known != std::end(kTextureNames)) return static_cast<TextureKind>(known - std::begin(kTextureNames));
  throw Error(Error::Code::kBadInput, "texture", formatted("'{}' is not known", name),
              "use none, procedural or density");
}

std::string_view nameOfTexture(TextureKind kind) noexcept {
  return kTextureNames[static_cast<std::size_t>(kind)];
}

std::string contactEffectNames(const EffectParameters& p) {
  std::string names;
  for (const EffectRow& row : kEffects) {
    if (row.asked(p)) names += (names.empty() ? "" : ", ") + std::string(row.name);
  }
  return names;
}

namespace {

bool hasTexture(const EffectParameters& p) noexcept {
  return p.texture != TextureKind::kNone && p.texture_amplitude_m > 0;
}

// Where objects hold the tool, K is whole, even if no density of the volume is that stiff.
double largestFactor(const EffectParameters& p) noexcept {
  double largest = 1;
  for (const StiffnessRow& row : p.stiffness_by_density) largest = std::max(largest, row.factor);
  return largest;
}

}  // namespace

double mostStiffening(const EffectParameters& p) noexcept {
  const double by_shading = p.force_shading ? std::hypot(1.0, ForceShading::kMostTurned) : 1;
  return by_shading * (hasTexture(p) ? kStiffeningTexture : 1) * largestFactor(p);
}

double mostStiffeningAside(const EffectParameters& p) noexcept {
  const double by_friction = p.friction.static_ratio > 0 ? 1 : 0;
  const double by_texture = hasTexture(p) ? 1 + kSteepestTexture * kSteepestTexture : 0;
  const double at_borders = p.stiffness_by_density.size() > 1 ? 1 : 0;
  return (by_friction + by_texture) * largestFactor(p) + at_borders;
}

ContactEffects makeContactEffects(const EffectParameters& p, double stiffness_N_per_m, double rate_hz) {
  checkParameters(p, stiffness_N_per_m, rate_hz);
  ContactEffects effects;
  for (const EffectRow& row : kEffects) {
    if (row.asked(p)) effects.push_back(row.make(p, {stiffness_N_per_m, rate_hz}));
  }
  return effects;
}

}  // namespace palpate
