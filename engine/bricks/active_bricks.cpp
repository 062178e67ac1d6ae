// SPDX-License-Identifier: Apache-2.0
#include "engine/bricks/active_bricks.hpp"

#include <algorithm>
#include <numeric>

namespace palpate {

std::vector<std::uint32_t> activeBricks(std::span<const layout::BrickBounds> bounds, const BrickGrid& grid,
                                        const layout::IsovaluePair& isovalues) {
  std::vector<bool> active(bounds.size());
  std::size_t index = 0;
  grid.forEach([&](const Vec3i& brick) {
    if (eitherCrosses(isovalues, bounds[index++]))
      grid.forEachAtCorner(brick, 1, [&](std::uint32_t other) { active[other] = true; });
  });
  std::vector<std::uint32_t> list;
  for (std::size_t b = 0; b < active.size(); ++b) {
    if (active[b]) list.push_back(static_cast<std::uint32_t>(b));
  }
  return list;
}

std::vector<std::uint32_t> inBlocks(std::vector<std::uint32_t> bricks, const BrickGrid& grid) {
  constexpr int kEdge = 16;
  const Vec3i blocks = grid.counts().array() / kEdge + 2;
  const auto blockOf = [&](std::uint32_t brick) {
    const Vec3i block = (grid.brick(brick).array() + kEdge / 2) / kEdge;
    return (static_cast<std::int64_t>(block.z()) * blocks.y() + block.y()) * blocks.x() + block.x();
  };
  std::stable_sort(bricks.begin(), bricks.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return blockOf(a) < blockOf(b); });
  return bricks;
}

std::vector<std::uint32_t> allBricks(const BrickGrid& grid) {
  std::vector<std::uint32_t> list(grid.brickCount());
  std::iota(list.begin(), list.end(), 0U);
  return list;
}

}  // namespace palpate
