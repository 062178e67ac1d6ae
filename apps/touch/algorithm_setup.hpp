// SPDX-License-Identifier: Apache-2.0
// apps/touch/algorithm_setup.hpp: from what a scene asks of the servo to what its algorithm is made from. Set-up code.
#pragma once

#include "engine/plan/scene.hpp"
#include "servo/algorithms/registry.hpp"

namespace palpate {

// `isovalue` as the volume has it [density]. Throws Error(kBadInput) on contact effects that cannot be made.
[[nodiscard]] AlgorithmSetup algorithmSetup(const Scene& scene, double isovalue);

}  // namespace palpate
