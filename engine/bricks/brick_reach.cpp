// SPDX-License-Identifier: Apache-2.0
#include "engine/bricks/brick_reach.hpp"

#include <algorithm>

namespace palpate {

void appendReached(const BrickGrid& grid, const VoxelBox& changed, const Reach& reach,
                   std::vector<std::uint32_t>& bricks) {
  const VoxelBox wide{(changed.first - Vec3i::Constant(reach.low)).cwiseMax(0),
                      (changed.last + Vec3i::Constant(reach.high)).cwiseMin(grid.size - Vec3i::Ones())};
  grid.forEachIn(wide, [&](const Vec3i& brick) { bricks.push_back(grid.index(brick)); });
}

void sortUnique(std::vector<std::uint32_t>& bricks) {
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
}

}  // namespace palpate
