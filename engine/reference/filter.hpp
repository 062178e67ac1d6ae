// SPDX-License-Identifier: Apache-2.0
// engine/reference/filter.hpp: the CPU twin of the filter kernels: every step over the whole field, voxel by voxel,
// with no bricks. Slow and obvious; any thread. Kernels must agree bit for bit, but for those with exponentials
// (bilateral, diffuse with g=exp), which are taken in double here: tests derive how far a kernel may be off.
#pragma once

#include <functional>
#include <span>

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Not one of a distance's steps, which only applyFilters takes, all of one together. `progress`, if there is one, gets
// the fraction done after each slice, and may throw to cancel.
[[nodiscard]] DenseField applyStep(const DenseField& field, const FilterStep& step,
                                   const std::function<void(double)>& progress = {});
[[nodiscard]] DenseField applyFilters(DenseField field, std::span<const FilterStep> steps,
                                      const std::function<void(double)>& progress = {});

// The density at a place that may lie beyond the border.
[[nodiscard]] float bordered(const DenseField& field, const Vec3i& voxel, Border border);

}  // namespace palpate::reference
