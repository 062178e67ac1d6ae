// SPDX-License-Identifier: Apache-2.0
// engine/reference/gradient.hpp: the CPU twin of shaders/gradient*.comp: each operator as a plain loop. Any thread; one
// pass over the volume. All in float, no contraction: kernels must agree bit for bit.
#pragma once

#include <array>
#include <functional>

#include "engine/gradient/gradient_operator.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Gradient at a voxel along the lattice's axes [density/m] by the stencil of an operator; the smoothing of one that
// smooths has been done before (smoothedFor). A neighbour beyond the border is the outermost voxel.
//   central   (f(1) - f(-1)) * (1 / 2h), at the border (f(1) - f(0)) * (1 / h) or (f(0) - f(-1)) * (1 / h)
//   sobel     the same of f smoothed across the axis by (f(-1) + f(1)) + (f(0) + f(0)), first along i, then j, then k;
//             j: differences are taken before the smoothing along k. Scale: 1 / 32h, at the border 1 / 16h.
//   central4  (8 (f(1) - f(-1)) - (f(2) - f(-2))) * (1 / 12h); closer than two voxels to the border as central
[[nodiscard]] std::array<float, 3> gradientAt(const DenseField& field, const GradientOperator& way, int i, int j,
                                              int k);

// The field whose gradient an operator takes. `progress`: as applyFilters has it.
[[nodiscard]] DenseField smoothedFor(const GradientOperator& way, DenseField field,
                                     const std::function<void(double)>& progress = {});

}  // namespace palpate::reference
