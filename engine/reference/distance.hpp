// SPDX-License-Identifier: Apache-2.0
// engine/reference/distance.hpp: the CPU twin of the distance kernels (shaders/filter_distance_*.comp). It works on
// whole fields, voxel by voxel, with surface points as plain offsets: slow and obvious. Kernels must agree bit for bit.
// Any thread.
#pragma once

#include <functional>
#include <span>

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Signed distance from the isosurface [m], positive in the object. `steps`: the kDistanceSteps steps of one distance
// filter. `progress`: as for applyFilters.
[[nodiscard]] DenseField signedDistance(const DenseField& field, std::span<const FilterStep> steps,
                                        const std::function<void(double)>& progress = {});

}  // namespace palpate::reference
