// SPDX-License-Identifier: Apache-2.0
#include "engine/field/brick_values.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

namespace palpate {

bool sameBits(float a, float b) noexcept {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

bool sameBits(std::span<const float, kBrickVoxels> a, std::span<const float, kBrickVoxels> b) noexcept {
  // Through const void*, since floats are to be compared as bytes: their values are equal for -0 and +0, and NaN is
  // not.
  return std::memcmp(static_cast<const void*>(a.data()), static_cast<const void*>(b.data()), a.size_bytes()) == 0;
}

bool holdOneValue(std::span<const float, kBrickVoxels> values) noexcept {
  return std::all_of(values.begin(), values.end(), [&](const float& value) { return sameBits(value, values[0]); });
}

void putBrick(Volume& volume, const Vec3i& brick, std::span<const float> values) {
  if (values.size() == 1) {
    volume.setConstantBrick(brick, values[0]);
  } else if (values.size() == kBrickVoxels) {
    volume.setBrick(brick, values.data());
  } else {
    throw std::length_error(
        fmt::format("brick ({}, {}, {}) has {} densities", brick.x(), brick.y(), brick.z(), values.size()));
  }
}

}  // namespace palpate
