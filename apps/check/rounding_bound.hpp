// SPDX-License-Identifier: Apache-2.0
// apps/check/rounding_bound.hpp: how far a kernel with an exponential may be off its twin, voxel by voxel, from the
// roundings in between. Any thread.
//
// The twin takes exponentials in double; the kernel takes them in float by a polynomial of its own
// (shaders/filter_exp.math.glsl), because Vulkan lets a device's exp be off by 3 + 2 |x| ULP. With u = 2^-24:
// the exponent -s^2 is off by 7 u of itself (the difference's rounding and the product's, both squared, and three in
// s^2 log2 e), the polynomial by 3.2 u, each operation by u, and a weight below 2^-125 counts for nothing.
#pragma once

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate {

// Whether a step has such a bound; the kernels of all others agree bit for bit.
[[nodiscard]] bool hasExponential(const FilterStep& step) noexcept;

// For a result of such a step at a voxel; `twin`: the twin's result there.
[[nodiscard]] double roundingBound(const reference::DenseField& before, const Vec3i& voxel, const FilterStep& step,
                                   double twin);

// For people: "bilateral: ...".
[[nodiscard]] const char* boundReason(const FilterStep& step) noexcept;

}  // namespace palpate
