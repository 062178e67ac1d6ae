// SPDX-License-Identifier: Apache-2.0
// apps/touch/algorithm_setup.hpp: turns a scene into the set-up of its haptic algorithm. Set-up code.
#pragma once

#include "apps/scene/scene.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"

namespace palpate {

// The contact effects of a scene. Throws Error(kBadInput) for an unknown texture.
[[nodiscard]] EffectParameters effectParameters(const Scene& scene);

// `isovalue`: of the field that is felt [density]; `scale`: how its densities lie about the isovalue; `objects`: those
// of the scene (scene_objects.hpp). The caller adds the mesh of the isosurface. Throws Error(kBadInput) for invalid
// contact effects.
[[nodiscard]] AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue, const DensityScale& scale = {},
                                            const ContactObjects& objects = {});

// How much damping the scene lacks for a passive wall [N s/m]; 0 if none. A sampled wall needs K T / 2 + K T d (Colgate
// and Schenkel 1997), with the scene's largest stiffness K, the period T of a tick and a force that is d ticks late. 0
// for an algorithm without a stiffness.
[[nodiscard]] double lackingDamping(const Scene& scene);

}  // namespace palpate
