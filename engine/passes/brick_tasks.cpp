// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/brick_tasks.hpp"

namespace palpate {

void BrickTasks::add(std::uint32_t brick, const SampleStore::Place& place, bool if_active) {
  if (by_slab_.size() <= place.slab) by_slab_.resize(place.slab + 1);
  by_slab_[place.slab].push_back({brick, if_active ? place.slot | IF_ACTIVE : place.slot});
}

std::vector<TaskRange> BrickTasks::moveTo(std::vector<layout::BrickTask>& list) {
  std::vector<TaskRange> ranges;
  for (std::uint32_t slab = 0; slab < by_slab_.size(); ++slab) {
    const auto& tasks = by_slab_[slab];
    if (tasks.empty()) continue;
    ranges.push_back({slab, static_cast<std::uint32_t>(list.size()), static_cast<std::uint32_t>(tasks.size())});
    list.insert(list.end(), tasks.begin(), tasks.end());
  }
  by_slab_.clear();
  return ranges;
}

}  // namespace palpate
