// SPDX-License-Identifier: Apache-2.0
// engine/reference/window.hpp: the CPU twin of shaders/window.comp. Any thread.
#pragma once

#include <vector>

#include "engine/reference/dense_field.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate::reference {

// The samples of the box [first, first + size) of the field: density, and the gradient of every voxel.
[[nodiscard]] std::vector<Sample> windowSamples(const DenseField& field, const Vec3i& first, const Vec3i& size);

}  // namespace palpate::reference
