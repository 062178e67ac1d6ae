// SPDX-License-Identifier: Apache-2.0
// apps/touch/algorithm_setup.hpp: from what a scene asks of the servo to what its algorithm is made from. Set-up code.
#pragma once

#include "engine/plan/scene.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

// `isovalue` as the volume has it [density]; `objects` those of the scene (scene_objects.hpp). The isosurface's mesh is
// left out.
[[nodiscard]] AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue, const ContactObjects& objects = {});

}  // namespace palpate
