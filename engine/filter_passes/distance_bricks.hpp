// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/distance_bricks.hpp: in which bricks a distance must be computed, and its value in all others.
// Any thread; cost: a few operations a brick, 27 more for each brick that the isosurface crosses.
#pragma once

#include <span>
#include <vector>

#include "engine/bricks/brick_grid.hpp"
#include "engine/filter/filter_step.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

// Pages for a distance's result. Slot 0 marks the bricks to compute: each brick whose cells the isosurface crosses, and
// the 26 around it. A distance reaches eight voxels at most, so no voxel of any other brick finds a surface point.
// Those bricks have NO_SLOT and the constant plus or minus the band. `bounds`: of the densities that `seed` reads.
[[nodiscard]] std::vector<layout::BrickPage> distanceBricks(const FilterStep& seed,
                                                            std::span<const layout::BrickBounds> bounds,
                                                            const BrickGrid& grid);

}  // namespace palpate
