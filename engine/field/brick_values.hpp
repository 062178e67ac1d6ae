// SPDX-License-Identifier: Apache-2.0
// engine/field/brick_values.hpp: a brick as a list of densities, the form in which rooms hand bricks to each other: all
// 512 (i fastest), or a single one for a constant brick. Thread: any; putBrick() as Volume::setBrick().
#pragma once

#include <span>

#include "engine/field/volume.hpp"

namespace palpate {

// Compares bits, not values: -0 differs from +0.
[[nodiscard]] bool sameBits(float a, float b) noexcept;
[[nodiscard]] bool sameBits(std::span<const float, kBrickVoxels> a, std::span<const float, kBrickVoxels> b) noexcept;

// Whether all 512 densities of a brick have the same bits. Such a brick is constant: it is stored as one value.
[[nodiscard]] bool holdOneValue(std::span<const float, kBrickVoxels> values) noexcept;

// Calls setConstantBrick() if `values` holds one density, setBrick() if it holds 512. Throws std::length_error for any
// other count and then changes nothing.
void putBrick(Volume& volume, const Vec3i& brick, std::span<const float> values);

}  // namespace palpate
