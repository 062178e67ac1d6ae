// SPDX-License-Identifier: Apache-2.0
// engine/reference/filter.hpp: the CPU twin of the filter kernels: every step over the whole field, voxel by voxel,
// without bricks. Slow and obvious; any thread. Kernels must agree bit for bit, except for filters with exponentials
// (bilateral, diffuse with g=exp). The twin takes those in double; apps/check/rounding_bound.hpp derives how far a
// kernel may be off.
#pragma once

#include <functional>
#include <span>

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Applies one step, or a chain of steps. Only applyFilters takes the steps of a distance, all steps of one distance
// together. `progress`, if given, gets the fraction done after each slice, and may throw to cancel.
[[nodiscard]] DenseField applyStep(const DenseField& field, const FilterStep& step,
                                   const std::function<void(double)>& progress = {});
[[nodiscard]] DenseField applyFilters(DenseField field, std::span<const FilterStep> steps,
                                      const std::function<void(double)>& progress = {});

// The density at a place that may lie beyond the border.
[[nodiscard]] float bordered(const DenseField& field, const Vec3i& voxel, Border border);

}  // namespace palpate::reference
