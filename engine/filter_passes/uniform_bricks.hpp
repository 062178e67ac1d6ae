// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/uniform_bricks.hpp: finds bricks around which a field holds one density everywhere. A filter
// step then gives such a brick one density too. Any thread.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>

#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/filter/filter_step.hpp"

namespace palpate {

// How many bricks beyond its own a step reads, along each axis, either way.
[[nodiscard]] inline Vec3i ringOf(const FilterStep& step) {
  return (step.reach.array() + kBrickSize - 1) / kBrickSize;
}

// The density that all bricks within `ring` of `brick` hold, if it is the same in all of them, bit for bit. Else empty.
// `constantOf(brick)`: the one density that a brick holds; empty if it holds several.
template <typename ConstantOf>
std::optional<float> uniformAround(const BrickGrid& grid, std::uint32_t brick, const Vec3i& ring,
                                   const ConstantOf& constantOf) {
  std::optional<float> density = constantOf(brick);
  if (!density) return density;
  const auto bits = std::bit_cast<std::uint32_t>(*density);
  grid.forEachWithin(grid.brick(brick), ring, [&](std::uint32_t other) {
    if (!density) return;
    const std::optional<float> beside = constantOf(other);
    if (!beside || std::bit_cast<std::uint32_t>(*beside) != bits) density.reset();
  });
  return density;
}

}  // namespace palpate
