// SPDX-License-Identifier: Apache-2.0
// engine/edit/edit_reach.hpp: which bricks an edit command can change. Any thread. Cost: depends on the command's size,
// not on the volume's. (A cut is as large as the half space that it clears.)
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "engine/bricks/brick_reach.hpp"
#include "engine/edit/lower_edit.hpp"

namespace palpate {

// Every brick in which the command may change a voxel, in ascending order. Some of them may turn out unchanged.
[[nodiscard]] std::vector<std::uint32_t> reachedBricks(const layout::EditCommand& command, const BrickGrid& grid);

// The box around all voxels that the command can change, clipped to the domain.
[[nodiscard]] VoxelBox reachedBox(const layout::EditCommand& command, const BrickGrid& grid);

// Whether the command may move a voxel of a reached brick across the isovalue. Beyond the new surface the ramp changes
// densities too, but they stay on one side of the isovalue.
[[nodiscard]] bool mayCross(const layout::EditCommand& command, const BrickGrid& grid, std::uint32_t brick);

// For a brick that holds `density` everywhere: the one density that it holds everywhere after the command. Empty if
// this is not certain.
[[nodiscard]] std::optional<float> uniformResult(const layout::EditCommand& command, const BrickGrid& grid,
                                                 std::uint32_t brick, float density);

}  // namespace palpate
