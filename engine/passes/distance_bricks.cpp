// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/distance_bricks.hpp"

#include "engine/passes/brick_pool.hpp"
#include "shaders/filter_distance.layout.h"

namespace palpate {

std::vector<layout::BrickPage> distanceBricks(const FilterStep& seed, std::span<const layout::BrickBounds> bounds,
                                              const Vec3i& brick_counts) {
  static_assert(kWidestBand + 2 <= kBrickSize);  // a voxel's spread, and the neighbour that a surface point leads to
  const float isovalue = seed.taps[DISTANCE_ISOVALUE];
  const float band = distanceBand(seed);
  std::vector<layout::BrickPage> pages;
  pages.reserve(bounds.size());
  for (const layout::BrickBounds& brick : bounds) pages.push_back({NO_SLOT, brick.lowest > isovalue ? band : -band});
  std::size_t index = 0;
  for (int z = 0; z < brick_counts.z(); ++z) {
    for (int y = 0; y < brick_counts.y(); ++y) {
      for (int x = 0; x < brick_counts.x(); ++x) {
        const layout::BrickBounds& own = bounds[index++];
        if (!crosses(isovalue, own)) continue;
        for (int n = 0; n < 27; ++n) {
          const Vec3i at(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1);
          if ((at.array() < 0).any() || (at.array() >= brick_counts.array()).any()) continue;
          const auto page = (static_cast<std::size_t>(at.z()) * static_cast<std::size_t>(brick_counts.y()) +
                             static_cast<std::size_t>(at.y())) *
                                static_cast<std::size_t>(brick_counts.x()) +
                            static_cast<std::size_t>(at.x());
          pages[page] = {0, 0.0F};
        }
      }
    }
  }
  return pages;
}

}  // namespace palpate
