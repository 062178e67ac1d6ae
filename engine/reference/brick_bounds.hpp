// SPDX-License-Identifier: Apache-2.0
// engine/reference/brick_bounds.hpp: the CPU twin of shaders/brick_bounds.comp, and of the search for the bricks that
// need gradients. Any thread.
#pragma once

#include <vector>

#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

struct Bounds {
  float lowest = 0;
  float highest = 0;
};

// Lowest and highest density over all cells whose first corner lies in the brick: 9x9x9 voxels, fewer at the domain's
// end.
[[nodiscard]] Bounds brickBounds(const DenseField& field, const Vec3i& brick);

// Linear indices (i fastest) of the bricks that hold a corner of a cell which the isosurface crosses, found cell by
// cell.
[[nodiscard]] std::vector<std::size_t> bricksOfCrossedCells(const DenseField& field, float isovalue);

}  // namespace palpate::reference
