// SPDX-License-Identifier: Apache-2.0
// apps/check/rounding_bound.hpp: a bound, for each voxel, on the difference between a filter kernel with an exponential
// and its twin. It is derived from the rounding of each operation. Any thread.
//
// The twin takes exponentials in double. The kernel takes them in float by its own polynomial
// (shaders/filter_exp.math.glsl), because Vulkan lets a device's exp be off by 3 + 2 |x| ULP. With u = 2^-24, relative
// errors are: 7 u in the exponent -s^2 (rounding of the difference and of the product, each doubled by the square, and
// three roundings in s^2 log2 e), 3.2 u in the polynomial, u in each other operation. Weights below 2^-125 count as 0.
#pragma once

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

// Whether a step has such a bound; the kernels of all others agree bit for bit.
[[nodiscard]] bool hasExponential(const FilterStep& step) noexcept;

// The bound for the result of such a step at a voxel. `before`: the step's input; `twin`: the twin's result at the
// voxel.
[[nodiscard]] double roundingBound(const reference::DenseField& before, const Vec3i& voxel, const FilterStep& step,
                                   double twin);

// The reason for the bound, for people: "bilateral: ...".
[[nodiscard]] const char* boundReason(const FilterStep& step) noexcept;

}  // namespace palpate
