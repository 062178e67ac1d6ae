// SPDX-License-Identifier: Apache-2.0
// servo/contact/effects.hpp: makes the contact effects that a scene asks for, in the order in which they act.
//
// The order, and why:
// 1. force shading decides where on the surface the VHIP is. Everything else starts from there.
// 2. recovery time takes the steps of plane switches out of that, and of nothing else. After friction it would smear
//    stick-slip, after texture the grain.
// 3. texture is felt in full. It changes the depth, which is friction's load.
// 4. friction holds the tool against all of the above. Its cone is about the direction that they gave the force.
// 5. stiffness by density scales the finished d = VHIP - HIP, and the energy that all of them store. Soft ground is
//    softer along the surface too, and the friction cone keeps its angle. Viscous friction scales as well. A friction
//    spring that was stretched on soft ground and relaxes on hard ground costs the hand what it gives back.
// The energy account acts last (energy_account.hpp).
// An effect that is not asked for is not made. Without effects the servo's tick has one comparison more. Set-up code:
// allocates and throws.
#pragma once

#include <string>
#include <string_view>

#include "servo/contact/contact_effect.hpp"
#include "servo/contact/friction.hpp"
#include "servo/contact/stiffness_table.hpp"

namespace palpate {

enum class TextureKind : std::uint8_t { kNone, kProcedural, kDensity };

// "none", "procedural" or "density". Throws Error(kBadInput) on another word.
[[nodiscard]] TextureKind textureOfName(std::string_view name);
[[nodiscard]] std::string_view nameOfTexture(TextureKind kind) noexcept;

struct EffectParameters {
  bool force_shading = false;
  double recovery_s = 0;  // 0: none
  TextureKind texture = TextureKind::kNone;
  double texture_amplitude_m = 0.1e-3;
  double texture_wavelength_m = 1e-3;                   // of the procedural texture
  double texture_gain = 1;                              // of the density texture [-]
  FrictionParameters friction = {};                     // all 0: none
  std::vector<StiffnessRow> stiffness_by_density = {};  // empty: none

  [[nodiscard]] bool operator==(const EffectParameters&) const = default;
};

// The names of the effects that makeContactEffects() makes of them, in the same order: "texture, friction"; empty:
// none.
[[nodiscard]] std::string contactEffectNames(const EffectParameters& parameters);

// By how much the effects multiply the contact's stiffness at most [-]: the largest change of the force for a motion of
// the tool along the normal, over K.
// - Force shading turns the force by up to 30 degrees, so it is up to 1 / cos(30 degrees) as long: 1.15.
// - Texture: kStiffeningTexture (texture.hpp).
// - Stiffness by density: the table's largest factor, at least 1, which other objects keep.
// Recovery and friction add no stiffness along the normal.
[[nodiscard]] double mostStiffening(const EffectParameters& parameters) noexcept;

// By how much of the contact's K the effects hold the tool along the surface at most [-]; 0: they do not. The surface's
// damping acts along the normal alone (vhip_algorithm.hpp), so such a spring has none. The sum of
// - friction: K;
// - texture: K times the square of its slope, and K for its bend (texture.hpp); both times the largest factor of
// - stiffness by density, and K where the factor changes (stiffness_by_density.hpp).
[[nodiscard]] double mostStiffeningAside(const EffectParameters& parameters) noexcept;

// `stiffness_N_per_m`: K of the contact; `rate_hz`: ticks a second. Throws Error(kBadInput) on a negative or non-finite
// value, a rate or wavelength of 0, a recovery of more than kLongestRecovery ticks, a dynamic friction above the static
// one, and a stiffness table that StiffnessTable refuses.
inline constexpr double kLongestRecovery = 1e6;  // [tick]
[[nodiscard]] ContactEffects makeContactEffects(const EffectParameters& parameters, double stiffness_N_per_m,
                                                double rate_hz);

}  // namespace palpate
