// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_tasks.hpp: lists of bricks whose samples a kernel writes or reads, sorted by sample slab, since a
// kernel sees one slab at a time. Any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/passes/sample_store.hpp"

namespace palpate {

// Tasks [first, first + count) of a list.
struct TaskRange {
  std::uint32_t slab = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

class BrickTasks {
 public:
  // A brick without samples may go with any slab. `if_active`: kernels look at the brick's bounds to see whether it has
  // samples (ActiveTest).
  void add(std::uint32_t brick, const SampleStore::Place& place, bool if_active = false);
  // Moves all tasks into `list`, slab by slab, and returns the range of each slab.
  [[nodiscard]] std::vector<TaskRange> moveTo(std::vector<layout::BrickTask>& list);

 private:
  std::vector<std::vector<layout::BrickTask>> by_slab_;
};

}  // namespace palpate
