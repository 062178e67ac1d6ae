// SPDX-License-Identifier: Apache-2.0
// apps/touch/rig_settings.hpp: turns a scene into the settings of the rig that feels it. Set-up code.
#pragma once

#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "servo/contact/effects.hpp"

namespace palpate {

// The contact effects of a scene. Throws Error(kBadInput) for an unknown texture.
[[nodiscard]] EffectParameters effectParameters(const Scene& scene);

// `isovalue`: of the field that is felt [density]. Throws Error(kBadInput) for an unknown texture.
[[nodiscard]] RigSettings rigSettings(const Scene& scene, double isovalue);

// How much damping the scene lacks for a passive wall [N s/m]; 0 if none. A sampled wall needs K T / 2 + K T d (Colgate
// and Schenkel 1997), with the scene's largest stiffness K, the period T of a tick and a force that is d ticks late. 0
// for an algorithm without a stiffness.
[[nodiscard]] double lackingDamping(const Scene& scene);

}  // namespace palpate
