// SPDX-License-Identifier: Apache-2.0
// engine/reference/gradient.hpp: the CPU twin of shaders/gradient*.comp. All arithmetic is in float without
// contraction; kernels must agree bit for bit. Any thread.
#pragma once

#include <array>
#include <functional>

#include "engine/gradient/gradient_operator.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Gradient at a voxel along the lattice's axes [density/m], by the stencil of an operator. For an operator that
// smooths, `field` is smoothed already (smoothedFor). A neighbour beyond the border is the outermost voxel. With
// spacing h:
//   central   (f(1) - f(-1)) * (1 / 2h), at the border (f(1) - f(0)) * (1 / h) or (f(0) - f(-1)) * (1 / h)
//   sobel     the same differences of f smoothed across the axis by (f(-1) + f(1)) + (f(0) + f(0)), first along i, then
//             j, then k; along j, differences are taken before the smoothing along k. Scale: 1 / 32h, at the border
//             1 / 16h
//   central4  (8 (f(1) - f(-1)) - (f(2) - f(-2))) * (1 / 12h); as central closer than two voxels to the border
[[nodiscard]] std::array<float, 3> gradientAt(const DenseField& field, const GradientOperator& gradient_operator, int i,
                                              int j, int k);

// The field whose gradient an operator takes: `field`, smoothed if the operator smooths. `progress`: as for
// applyFilters.
[[nodiscard]] DenseField smoothedFor(const GradientOperator& gradient_operator, DenseField field,
                                     const std::function<void(double)>& progress = {});

}  // namespace palpate::reference
