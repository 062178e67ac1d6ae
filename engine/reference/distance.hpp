// SPDX-License-Identifier: Apache-2.0
// engine/reference/distance.hpp: the CPU twin of the distance kernels (shaders/filter_distance_*.comp): whole fields,
// surface points as plain offsets, one voxel after another. Slow and obvious; any thread. Agrees bit for bit.
#pragma once

#include <functional>
#include <span>

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Signed distance from the isosurface [m], positive in the object. `steps`: the kDistanceSteps of one distance.
// `progress`: as applyFilters has it.
[[nodiscard]] DenseField signedDistance(const DenseField& field, std::span<const FilterStep> steps,
                                        const std::function<void(double)>& progress = {});

}  // namespace palpate::reference
