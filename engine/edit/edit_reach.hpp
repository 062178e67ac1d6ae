// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_reach.hpp: where in the volume an edit command can change anything, brick by brick. Any thread.
// Cost: follows the command's size, not the volume's (a cut's size is its half of the volume).
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/edit/brick_grid.hpp"
#include "engine/edit/lower_edit.hpp"

namespace palpate {

// Every brick in which the command may change a voxel, ascending; some in which it does not may be among them.
[[nodiscard]] std::vector<std::uint32_t> reachedBricks(const layout::EditCommand& command, const BrickGrid& grid);

// Box around all that the command can change, cut to the domain.
[[nodiscard]] VoxelBox reachedBox(const layout::EditCommand& command, const BrickGrid& grid);

// Whether the command may move a voxel of a reached brick across the isovalue: what a ramp does outside its surface, it
// does on one side of the isovalue.
[[nodiscard]] bool mayCross(const layout::EditCommand& command, const BrickGrid& grid, std::uint32_t brick);

// The one density that a brick which holds `density` everywhere holds after the command, if that is certain.
[[nodiscard]] std::optional<float> uniformResult(const layout::EditCommand& command, const BrickGrid& grid,
                                                 std::uint32_t brick, float density);

// How far a pass carries a change: a result at voxel v depends on densities at v - high ... v + low along every axis,
// so a changed voxel c changes results at c - low ... c + high. [voxel] Gradients: GradientPass::reach().
struct Reach {
  int low = 0;
  int high = 0;
};
inline constexpr Reach kBoundsReach{1, 0};  // a brick's cells end in the first voxels of the bricks behind it

// The bricks that hold a voxel within `reach` of a brick's changed voxels.
void appendReached(const BrickGrid& grid, const VoxelBox& changed, const Reach& reach,
                   std::vector<std::uint32_t>& bricks);

void sortUnique(std::vector<std::uint32_t>& bricks);

}  // namespace palpate
