// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_dispatch.hpp: records the steps of a filter chain as dispatches. It holds their kernels
// (shaders/filter_*.comp), each compiled when first needed, and the buffers of their taps. Taps are the weights and
// parameters of a step; steps with equal taps share a buffer. Thread: the Gpu's.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/filter/filter_step.hpp"
#include "engine/filter_passes/filter_kernels.hpp"
#include "engine/filter_passes/filter_tasks.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

class FilterDispatch {
 public:
  FilterDispatch(gpu::Gpu& gpu, gpu::Transfer& transfer, std::vector<FilterStep> steps);

  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return steps_; }
  // Whether a step has its own kernel for bricks at the volume's border.
  [[nodiscard]] bool hasEdge(std::size_t step) const noexcept { return kinds_[step].has_edge; }

  // Records a step that reads `from` and writes slots of `to`. It covers the bricks of `ranges` in `tasks` (a list of
  // layout::FilterTask).
  void record(gpu::Commands& commands, std::size_t step, const BrickPool& from, const BrickPool& to,
              const gpu::Buffer& tasks, std::span<const FilterRange> ranges);
  // The kernel of a step, made for the present slabs of `from`. Throws Error(kDevice).
  const gpu::Kernel& kernel(std::size_t step, const BrickPool& from, bool edge);

 private:
  gpu::Gpu& gpu_;
  std::vector<FilterStep> steps_;
  std::vector<FilterKernel> kinds_;             // of each step
  std::vector<std::size_t> taps_;               // of each step: index into tap_buffers_
  std::vector<gpu::Buffer> tap_buffers_;        // no two are equal
  std::map<std::string, gpu::Kernel> kernels_;  // by name and constants
};

}  // namespace palpate
