// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/active_bricks.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace palpate {
namespace {

void markWithHalo(std::vector<bool>& active, const Vec3i& counts, const Vec3i& brick) {
  const Vec3i end = (brick.array() + 1).min(counts.array() - 1);
  for (int z = brick.z(); z <= end.z(); ++z) {
    for (int y = brick.y(); y <= end.y(); ++y) {
      for (int x = brick.x(); x <= end.x(); ++x) {
        active[(static_cast<std::size_t>(z) * counts.y() + y) * counts.x() + x] = true;
      }
    }
  }
}

}  // namespace

std::vector<std::uint32_t> activeBricks(std::span<const layout::BrickBounds> bounds, const Vec3i& brick_counts,
                                        const layout::IsovaluePair& isovalues) {
  std::vector<bool> active(bounds.size());
  std::size_t index = 0;
  for (int z = 0; z < brick_counts.z(); ++z) {
    for (int y = 0; y < brick_counts.y(); ++y) {
      for (int x = 0; x < brick_counts.x(); ++x, ++index) {
        if (eitherCrosses(isovalues, bounds[index])) markWithHalo(active, brick_counts, {x, y, z});
      }
    }
  }
  std::vector<std::uint32_t> list;
  for (std::size_t b = 0; b < active.size(); ++b) {
    if (active[b]) list.push_back(static_cast<std::uint32_t>(b));
  }
  return list;
}

std::vector<std::uint32_t> inBlocks(std::vector<std::uint32_t> bricks, const Vec3i& brick_counts) {
  constexpr std::uint32_t kEdge = 16;
  const Eigen::Vector<std::uint32_t, 3> counts = brick_counts.cast<std::uint32_t>();
  const Eigen::Vector<std::uint32_t, 3> blocks = counts.array() / kEdge + 2;
  const auto blockOf = [&](std::uint32_t brick) {
    const auto block = [](std::uint32_t at) { return (at + kEdge / 2) / kEdge; };
    return (block(brick / (counts.x() * counts.y())) * blocks.y() + block(brick / counts.x() % counts.y())) *
               blocks.x() +
           block(brick % counts.x());
  };
  std::stable_sort(bricks.begin(), bricks.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return blockOf(a) < blockOf(b); });
  return bricks;
}

std::vector<std::uint32_t> allBricks(const Vec3i& brick_counts) {
  std::vector<std::uint32_t> list(static_cast<std::size_t>(brick_counts.prod()));
  std::iota(list.begin(), list.end(), 0U);
  return list;
}

}  // namespace palpate
