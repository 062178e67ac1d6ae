// SPDX-License-Identifier: Apache-2.0
// apps/check/distance_bounds.hpp: a distance against brute force, which knows nothing of surface points and tangent
// planes: of every voxel the nearest one across the isovalue is looked for. The surface crosses the way to it, so it is
// no farther than that voxel, and a cell that it crosses has a voxel across at a corner, so it is no nearer than that
// voxel less a cell's diagonal. Any thread. Cost: engine/reference/nearest_across.hpp.
#pragma once

#include <functional>
#include <span>

#include "apps/check/check.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

// Compares `distance`, what the steps of one distance made of `densities`, with these bounds, cut off at the band, on
// the side on which the density lies. `progress`: gets the fraction done, and may throw to cancel.
void compareWithNearestAcross(Check& check, const reference::DenseField& distance,
                              const reference::DenseField& densities, std::span<const FilterStep> steps,
                              const std::function<void(double)>& progress);

}  // namespace palpate
