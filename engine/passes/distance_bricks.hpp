// SPDX-License-Identifier: Apache-2.0
// engine/passes/distance_bricks.hpp: in which bricks a distance has to be worked out, and what it is in all others. Any
// thread; cost: a few operations a brick, 27 more for each that the isosurface crosses.
#pragma once

#include <span>
#include <vector>

#include "base/vec.hpp"
#include "engine/filter/filter_step.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

// Pages of a distance's result. Slot 0: the bricks next to one whose cells the isosurface crosses, and that brick; a
// distance reaches eight voxels at most, so a voxel of any other brick knows no surface point. NO_SLOT: the others,
// with plus or minus the band. `bounds`: of the densities that `seed` reads.
[[nodiscard]] std::vector<layout::BrickPage> distanceBricks(const FilterStep& seed,
                                                            std::span<const layout::BrickBounds> bounds,
                                                            const Vec3i& brick_counts);

}  // namespace palpate
