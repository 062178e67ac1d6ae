// SPDX-License-Identifier: Apache-2.0
// engine/passes/active_bricks.hpp: which bricks need gradients. Any thread; cost: a few operations a brick.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

// The bricks whose cells the isosurface crosses, and their halo: the bricks that hold the far corners of such cells
// (one brick further along +i, +j, +k). So every cell on the isosurface has a gradient at all its corners. Linear page
// indices, ascending.
[[nodiscard]] std::vector<std::uint32_t> activeBricks(std::span<const layout::BrickBounds> bounds,
                                                      const Vec3i& brick_counts, float isovalue);

[[nodiscard]] std::vector<std::uint32_t> allBricks(const Vec3i& brick_counts);

// The same bricks in blocks of 16x16x16: what a tool works on lies together. Where slots are given in this order, an
// edit or a window meets one slab of samples, seldom two, and each costs a dispatch. Blocks are shifted by half, so
// that none begins in the middle of a volume of a power of two.
[[nodiscard]] std::vector<std::uint32_t> inBlocks(std::vector<std::uint32_t> bricks, const Vec3i& brick_counts);

}  // namespace palpate
