// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/constant_bricks.hpp: finds the bricks of a filter step's result that hold one value everywhere.
// They need neither storage nor a kernel. Any thread.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/bricks/brick_grid.hpp"
#include "engine/field/volume.hpp"
#include "engine/filter/filter_step.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

// How many bricks beyond its own a step reads, along each axis, either way.
[[nodiscard]] inline Vec3i ringOf(const FilterStep& step) {
  return (step.reach.array() + kBrickSize - 1) / kBrickSize;
}

// The density that all bricks within `ring` of `brick` hold, if it is the same in all of them, bit for bit. Else empty.
// A filter step then gives `brick` one value too (uniformResult). `constantOf(brick)`: the one density that a brick
// holds; empty if it holds several.
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

// The page table of a distance field, where slot 0 marks the bricks to compute: each brick whose cells the isosurface
// crosses, and the 26 around it. A distance reaches eight voxels at most, so no voxel of any other brick finds a
// surface point. Those bricks have NO_SLOT and the constant plus or minus the band. `bounds`: of the densities that
// `seed` reads. Cost: a few operations a brick, 27 more for each brick that the isosurface crosses.
[[nodiscard]] std::vector<layout::BrickPage> distanceBricks(const FilterStep& seed,
                                                            std::span<const layout::BrickBounds> bounds,
                                                            const BrickGrid& grid);

}  // namespace palpate
