// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/constant_bricks.hpp"

#include "engine/passes/brick_pool.hpp"
#include "shaders/filter_distance.layout.h"

namespace palpate {

std::vector<layout::BrickPage> distanceBricks(const FilterStep& seed, std::span<const layout::BrickBounds> bounds,
                                              const BrickGrid& grid) {
  static_assert(kWidestBand + 2 <= kBrickSize);  // the spread (band + 1), then a voxel to the surface point
  const float isovalue = seed.taps[DISTANCE_ISOVALUE];
  const float band = distanceBand(seed);
  std::vector<layout::BrickPage> pages;
  pages.reserve(bounds.size());
  for (const layout::BrickBounds& brick : bounds) pages.push_back({NO_SLOT, brick.lowest > isovalue ? band : -band});
  std::size_t index = 0;
  grid.forEach([&](const Vec3i& brick) {
    if (crosses(isovalue, bounds[index++]))
      grid.forEachAround(brick, [&](std::uint32_t other) { pages[other] = {0, 0.0F}; });
  });
  return pages;
}

}  // namespace palpate
