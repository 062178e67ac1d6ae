// SPDX-License-Identifier: Apache-2.0
#include "servo/contact/effects.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "servo/contact/force_shading.hpp"
#include "servo/contact/recovery.hpp"
#include "servo/contact/stiffness_by_density.hpp"
#include "servo/contact/texture.hpp"

namespace palpate {
namespace {

void check(bool good, const char* input, double value, const char* remedy) {
  if (!good) throw Error(Error::Code::kBadInput, input, fmt::format("{:g} cannot be used", value), remedy);
}

void checkNotNegative(const char* input, double value) {
  check(std::isfinite(value) && value >= 0, input, value, "give 0 or more");
}

void checkParameters(const EffectParameters& p, double stiffness_N_per_m, double rate_hz) {
  checkNotNegative("stiffness", stiffness_N_per_m);
  check(std::isfinite(rate_hz) && rate_hz > 0, "rate", rate_hz, "give more than 0 Hz");
  checkNotNegative("recovery time", p.recovery_s);
  check(p.recovery_s * rate_hz <= kLongestRecovery, "recovery time", p.recovery_s, "give a shorter time");
  checkNotNegative("texture amplitude", p.texture_amplitude_m);
  check(std::isfinite(p.texture_wavelength_m) && p.texture_wavelength_m > 0, "texture wavelength",
        p.texture_wavelength_m, "give more than 0 mm");
  checkNotNegative("texture gain", p.texture_gain);
  checkNotNegative("static friction", p.friction.static_ratio);
  checkNotNegative("dynamic friction", p.friction.dynamic_ratio);
  checkNotNegative("viscous friction", p.friction.viscous_Ns_per_m);
  check(p.friction.dynamic_ratio <= p.friction.static_ratio, "dynamic friction", p.friction.dynamic_ratio,
        fmt::format("give at most the static friction, {:g}", p.friction.static_ratio).c_str());
}

// A recovery time below a tick is a tick: that is no recovery, but harmless.
int recoveryTicks(double recovery_s, double rate_hz) {
  return static_cast<int>(std::max(1.0, std::round(recovery_s * rate_hz)));
}

}  // namespace

TextureKind textureOfName(std::string_view name) {
  if (name == "none") return TextureKind::kNone;
  if (name == "procedural") return TextureKind::kProcedural;
  if (name == "density") return TextureKind::kDensity;
  throw Error(Error::Code::kBadInput, "texture", fmt::format("'{}' is not known", name),
              "use none, procedural or density");
}

ContactEffects makeContactEffects(const EffectParameters& p, double stiffness_N_per_m, double rate_hz) {
  checkParameters(p, stiffness_N_per_m, rate_hz);
  ContactEffects effects;
  if (p.force_shading) effects.push_back(std::make_unique<ForceShading>());
  if (p.recovery_s > 0) effects.push_back(std::make_unique<Recovery>(recoveryTicks(p.recovery_s, rate_hz)));
  if (p.texture == TextureKind::kProcedural) {
    effects.push_back(std::make_unique<ProceduralTexture>(p.texture_amplitude_m, p.texture_wavelength_m));
  } else if (p.texture == TextureKind::kDensity) {
    effects.push_back(std::make_unique<DensityTexture>(p.texture_amplitude_m, p.texture_gain));
  }
  if (p.friction.static_ratio > 0 || p.friction.viscous_Ns_per_m > 0) {
    effects.push_back(std::make_unique<Friction>(p.friction, stiffness_N_per_m, rate_hz));
  }
  if (!p.stiffness_by_density.empty()) {
    effects.push_back(std::make_unique<StiffnessByDensity>(StiffnessTable(p.stiffness_by_density)));
  }
  return effects;
}

}  // namespace palpate
