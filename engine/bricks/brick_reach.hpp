// SPDX-License-Identifier: Apache-2.0
// engine/bricks/brick_reach.hpp: which bricks a pass must compute anew where voxels have changed. Any thread. Cost:
// follows the change's size, not the volume's.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/bricks/brick_grid.hpp"

namespace palpate {

// How far a pass carries a change [voxel]. A changed voxel c changes results at c - low ... c + high along every axis,
// because a result at voxel v depends on densities at v - high ... v + low. Gradients: GradientPass::reach().
struct Reach {
  int low = 0;
  int high = 0;
};
inline constexpr Reach kBoundsReach{1, 0};  // a brick's last cells end at the first voxels of the next bricks

// Appends the bricks that hold a voxel within `reach` of the box `changed`.
void appendReached(const BrickGrid& grid, const VoxelBox& changed, const Reach& reach,
                   std::vector<std::uint32_t>& bricks);

void sortUnique(std::vector<std::uint32_t>& bricks);

}  // namespace palpate
