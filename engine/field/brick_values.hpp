// SPDX-License-Identifier: Apache-2.0
// engine/field/brick_values.hpp: the 512 densities of a brick (i fastest), or the one that it holds everywhere, as
// they are handed from one room to another. Any thread.
#pragma once

#include <span>

#include "engine/field/volume.hpp"

namespace palpate {

// Bits, not values: -0 is not +0.
[[nodiscard]] bool sameBits(float a, float b) noexcept;

// Whether all of a brick's 512 densities have the same bits: such a brick is one value, and has no storage.
[[nodiscard]] bool holdOneValue(std::span<const float, kBrickVoxels> values) noexcept;

// setConstantBrick() or setBrick(), by the count: one value or 512. Throws std::length_error for any other, and changes
// nothing then.
void putBrick(Volume& volume, const Vec3i& brick, std::span<const float> values);

}  // namespace palpate
