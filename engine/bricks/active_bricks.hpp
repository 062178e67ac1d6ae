// SPDX-License-Identifier: Apache-2.0
// engine/bricks/active_bricks.hpp: which bricks are active, that is, need gradients. Any thread; cost: a few operations
// a brick.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/bricks/brick_grid.hpp"
#include "shaders/brick_pool.layout.h"

namespace palpate {

// The bricks whose cells an isosurface crosses, and their halo: the next bricks along +i, +j and +k, which hold the far
// corners of such cells. So every cell on the isosurface has a gradient at all its corners. Returns linear page
// indices, ascending.
[[nodiscard]] std::vector<std::uint32_t> activeBricks(std::span<const layout::BrickBounds> bounds,
                                                      const BrickGrid& grid, const layout::IsovaluePair& isovalues);
[[nodiscard]] inline std::vector<std::uint32_t> activeBricks(std::span<const layout::BrickBounds> bounds,
                                                             const BrickGrid& grid, float isovalue) {
  return activeBricks(bounds, grid, layout::IsovaluePair{isovalue, isovalue});
}

[[nodiscard]] std::vector<std::uint32_t> allBricks(const BrickGrid& grid);

// The same bricks, ordered by blocks of 16x16x16 bricks, so that bricks near each other get slots near each other. An
// edit or a window then meets one slab of samples, seldom two; each slab costs a dispatch. Blocks are shifted by half a
// block, so that no border between blocks lies in the middle of a volume whose size is a power of two.
[[nodiscard]] std::vector<std::uint32_t> inBlocks(std::vector<std::uint32_t> bricks, const BrickGrid& grid);

}  // namespace palpate
