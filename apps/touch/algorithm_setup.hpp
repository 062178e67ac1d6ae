// SPDX-License-Identifier: Apache-2.0
// apps/touch/algorithm_setup.hpp: from what a scene asks of the servo to what its algorithm is made from. Set-up code.
#pragma once

#include "engine/plan/plan.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

// `isovalue` as the volume has it [density]; `scale`: how its densities lie about it; `objects` those of the scene
// (scene_objects.hpp). The isosurface's mesh is left out. Throws Error(kBadInput) on contact effects that cannot be
// made.
[[nodiscard]] AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue, const DensityScale& scale = {},
                                            const ContactObjects& objects = {});

// What the scene's damping is below K T / 2 + K T d, which a wall of its largest stiffness, held over a tick T and d
// ticks late, needs to be passive (Colgate and Schenkel 1997); 0 where it is not, and for an algorithm without K
// [N s/m].
[[nodiscard]] double lackingDamping(const Scene& scene);

// The scene's plan: an algorithm that feels away from the isosurface gets gradients there, one that touches a mesh of
// the isosurface gets that. Throws Error(kBadInput) on an algorithm that is not known.
[[nodiscard]] Plan planFor(const Scene& scene);

}  // namespace palpate
