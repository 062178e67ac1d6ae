// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_tasks.hpp"

#include "engine/field/volume.hpp"

namespace palpate {

bool FilterTasks::atEdge(const Vec3i& brick) const noexcept {
  const Vec3i first = brick * kBrickSize;
  for (int axis = 0; axis < 3; ++axis) {
    if (step_.reach[axis] == 0) continue;
    const bool inside =
        first[axis] >= step_.reach[axis] && first[axis] + kBrickSize - 1 + step_.reach[axis] < grid_.size[axis];
    if (!inside) return true;
  }
  return false;
}

void FilterTasks::add(std::uint32_t brick, std::uint32_t slot) {
  auto& by_slab = by_edge_and_slab_[has_edge_ && atEdge(grid_.brick(brick)) ? 1 : 0];
  const std::size_t slab = slot / BRICKS_PER_DENSITY_SLAB;
  if (by_slab.size() <= slab) by_slab.resize(slab + 1);
  by_slab[slab].push_back({brick, slot % BRICKS_PER_DENSITY_SLAB});
}

std::vector<FilterRange> FilterTasks::moveTo(std::vector<layout::FilterTask>& list) {
  std::vector<FilterRange> ranges;
  for (std::size_t edge = 0; edge < 2; ++edge) {
    auto& by_slab = by_edge_and_slab_[edge];
    for (std::size_t slab = 0; slab < by_slab.size(); ++slab) {
      const auto& tasks = by_slab[slab];
      if (tasks.empty()) continue;
      ranges.push_back(
          {edge == 1, slab, static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(tasks.size())});
      list.insert(list.end(), tasks.begin(), tasks.end());
    }
    by_slab.clear();
  }
  return ranges;
}

}  // namespace palpate
