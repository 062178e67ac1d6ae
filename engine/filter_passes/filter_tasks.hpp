// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_tasks.hpp: sorts the bricks that a filter step writes into ranges. One dispatch does one
// range. The bricks of a range lie in one slab of the step's output, and either all or none of them are at the volume's
// border. Any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/bricks/brick_reach.hpp"
#include "engine/filter/filter_step.hpp"
#include "shaders/filter.layout.h"

namespace palpate {

struct FilterRange {
  bool edge = false;  // the step reads beyond the volume's border for these bricks
  std::size_t slab = 0;
  std::uint32_t first = 0, count = 0;  // range in a list of tasks
};

class FilterTasks {
 public:
  // `has_edge`: the step has a kernel of its own for bricks at the border.
  FilterTasks(const BrickGrid& grid, const FilterStep& step, bool has_edge)
      : grid_(grid), step_(step), has_edge_(has_edge) {}

  void add(std::uint32_t brick, std::uint32_t slot);
  // Moves all tasks to the end of `list` and returns their ranges.
  [[nodiscard]] std::vector<FilterRange> moveTo(std::vector<layout::FilterTask>& list);

 private:
  [[nodiscard]] bool atEdge(const Vec3i& brick) const noexcept;

  const BrickGrid& grid_;
  const FilterStep& step_;
  bool has_edge_;
  std::array<std::vector<std::vector<layout::FilterTask>>, 2> by_edge_and_slab_;
};

}  // namespace palpate
