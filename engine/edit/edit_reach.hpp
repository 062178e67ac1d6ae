// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_reach.hpp: which bricks an edit command can change, and which bricks a pass must then compute anew.
// Any thread. Cost: follows the command's size, not the volume's. (A cut is as large as the half space that it clears.)
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/edit/brick_grid.hpp"
#include "engine/edit/lower_edit.hpp"

namespace palpate {

// Every brick in which the command may change a voxel, in ascending order. Some of them may turn out unchanged.
[[nodiscard]] std::vector<std::uint32_t> reachedBricks(const layout::EditCommand& command, const BrickGrid& grid);

// Box around all that the command can change, cut to the domain.
[[nodiscard]] VoxelBox reachedBox(const layout::EditCommand& command, const BrickGrid& grid);

// Whether the command may move a voxel of a reached brick across the isovalue. Beyond the new surface the ramp changes
// densities too, but only on one side of the isovalue.
[[nodiscard]] bool mayCross(const layout::EditCommand& command, const BrickGrid& grid, std::uint32_t brick);

// For a brick that holds `density` everywhere: the one density that it holds everywhere after the command, if that is
// certain.
[[nodiscard]] std::optional<float> uniformResult(const layout::EditCommand& command, const BrickGrid& grid,
                                                 std::uint32_t brick, float density);

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
