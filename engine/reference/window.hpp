// SPDX-License-Identifier: Apache-2.0
// engine/reference/window.hpp: the CPU twin of shaders/window.comp. Any thread.
#pragma once

#include <vector>

#include "engine/gradient/gradient_operator.hpp"
#include "engine/gradient/sample_format.hpp"
#include "engine/reference/dense_field.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate::reference {

// The samples of the box [first, first + size) of the field: density and gradient of every voxel, the gradient by the
// given operator, both rounded as `format` stores them.
[[nodiscard]] std::vector<Sample> windowSamples(const DenseField& field, const Vec3i& first, const Vec3i& size,
                                                const GradientOperator& gradient_operator = {},
                                                const SampleFormat& format = {});

}  // namespace palpate::reference
