// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_dispatch.hpp: the steps of a chain as dispatches: their kernels (shaders/filter_*.comp), each
// compiled when it is first needed, and the taps that these are handed, one buffer for all steps that have the same.
// Thread: the Gpu's.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/filter/filter_step.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/filter_kernels.hpp"
#include "engine/passes/filter_tasks.hpp"

namespace palpate {

class FilterDispatch {
 public:
  FilterDispatch(gpu::Gpu& gpu, gpu::Transfer& transfer, std::vector<FilterStep> steps);

  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return steps_; }
  // Whether bricks at the volume's border have a kernel of their own.
  [[nodiscard]] bool hasEdge(std::size_t step) const noexcept { return kinds_[step].has_edge; }

  // The bricks of `ranges` in `tasks` (layout::FilterTask): what the step makes of `from`, into the slots of `to`.
  void record(gpu::Commands& commands, std::size_t step, const BrickPool& from, const BrickPool& to,
              const gpu::Buffer& tasks, std::span<const FilterRange> ranges);
  // For `from`'s slabs as they are; throws Error(kDevice).
  const gpu::Kernel& kernel(std::size_t step, const BrickPool& from, bool edge);

 private:
  gpu::Gpu& gpu_;
  std::vector<FilterStep> steps_;
  std::vector<FilterKernel> kinds_;             // of each step
  std::vector<std::size_t> taps_;               // of each step: which of the buffers
  std::vector<gpu::Buffer> tap_buffers_;        // no two alike
  std::map<std::string, gpu::Kernel> kernels_;  // by name and constants
};

}  // namespace palpate
