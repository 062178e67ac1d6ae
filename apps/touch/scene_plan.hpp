// SPDX-License-Identifier: Apache-2.0
// apps/touch/scene_plan.hpp: what a scene needs of engine and servo, and in words what was done and what was left out.
// `palpate plan` prints it; `palpate touch` keeps it in summary.json. Any thread.
#pragma once

#include <vector>

#include "apps/scene/scene.hpp"
#include "engine/plan/plan.hpp"

namespace palpate {

// The scene's plan, with what its algorithm needs: gradients everywhere if it feels away from the isosurface. Throws
// Error(kBadInput) for an unknown algorithm, and as makePlan() does.
[[nodiscard]] Plan planFor(const Scene& scene);

// A line for each pass and buffer of the engine and each part of the servo. `mesh_triangles`: of the isosurface's mesh;
// 0: not extracted (yet).
[[nodiscard]] std::vector<PlanLine> scenePlanLines(const Scene& scene, const Plan& plan, const PlanFacts& facts,
                                                   std::size_t mesh_triangles = 0);

}  // namespace palpate
