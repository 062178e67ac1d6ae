// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/effect_kinds.hpp: the effects one by one, as the tests of rough surfaces set them.
#pragma once

#include "servo/contact/effects.hpp"

namespace palpate {

enum EffectKind { kNone, kShading, kProcedural, kDensity, kStiffness, kFriction, kRecovery, kEffectKinds };
inline constexpr const char* kEffectNames[] = {"none",      "shading",  "procedural", "density",
                                               "stiffness", "friction", "recovery"};

// `isovalue` and `contrast_per_mm`: the density at the surface, and how much it rises with a millimetre of depth.
inline EffectParameters effectOf(int kind, double isovalue, double contrast_per_mm) {
  EffectParameters p;
  if (kind == kShading) p.force_shading = true;
  if (kind == kProcedural) p.texture = TextureKind::kProcedural;
  if (kind == kDensity) p.texture = TextureKind::kDensity;
  if (kind == kStiffness)
    p.stiffness_by_density = {{isovalue + 0.5 * contrast_per_mm, 1}, {isovalue + 2 * contrast_per_mm, 2}};
  if (kind == kFriction) p.friction = {0.5, 0.4, 0};
  if (kind == kRecovery) p.recovery_s = 0.05;
  return p;
}

}  // namespace palpate
