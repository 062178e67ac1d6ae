// SPDX-License-Identifier: Apache-2.0
// apps/check/distance_bounds.hpp: checks a distance filter against brute force, which uses no surface points or tangent
// planes. For every voxel it searches for the nearest voxel on the other side of the isovalue
// (engine/reference/nearest_across.hpp, which gives the cost). The surface crosses the line to that voxel, so it is not
// farther. A cell that the surface crosses has a corner on the other side, so the surface is not nearer than that voxel
// less a cell's diagonal. Any thread.
#pragma once

#include <functional>
#include <span>

#include "apps/check/check.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

// Compares `distance`, the result of one distance filter's `steps` on `densities`, with these bounds, which are clamped
// to the band and have the sign of the voxel's side. `progress` gets the fraction done, and may throw to cancel.
void compareWithNearestAcross(Check& check, const reference::DenseField& distance,
                              const reference::DenseField& densities, std::span<const FilterStep> steps,
                              const std::function<void(double)>& progress);

}  // namespace palpate
