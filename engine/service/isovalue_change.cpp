// SPDX-License-Identifier: Apache-2.0
#include "engine/service/isovalue_change.hpp"

#include <algorithm>

#include "engine/bricks/active_bricks.hpp"
#include "engine/service/edit_plan.hpp"

namespace palpate {

IsovalueChange::IsovalueChange(SampleStore& store, GradientPass& gradient, const BrickGrid& grid,
                               std::span<const layout::BrickBounds> bounds, float to)
    : store_(store), gradient_(gradient), grid_(grid), missing_(activeBricks(bounds, grid, to)) {
  missing_.erase(std::remove_if(missing_.begin(), missing_.end(), [&](std::uint32_t b) { return store.has(b); }),
                 missing_.end());
  missing_ = inBlocks(std::move(missing_), grid);
  std::reverse(missing_.begin(), missing_.end());
  store_.reserve(missing_.size());
}

bool IsovalueChange::gather(std::size_t most) {
  std::vector<std::uint32_t> portion;
  for (; !missing_.empty() && portion.size() < most; missing_.pop_back())
    if (!store_.has(missing_.back())) portion.push_back(missing_.back());  // otherwise an edit has sampled it
  if (portion.empty()) return true;
  store_.reserve(portion.size());
  for (const std::uint32_t brick : portion) store_.add(brick, neighbourWithSamples(grid_, store_, brick));
  gradient_.run(portion);
  return missing_.empty();
}

void dropInactive(SampleStore& store, const BrickGrid& grid, std::span<const layout::BrickBounds> bounds,
                  const layout::IsovaluePair& isovalues) {
  const std::vector<std::uint32_t> active = activeBricks(bounds, grid, isovalues);
  for (const std::uint32_t brick : store.bricks())
    if (!std::binary_search(active.begin(), active.end(), brick)) store.remove(brick);
}

}  // namespace palpate
