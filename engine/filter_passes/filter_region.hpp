// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_region.hpp: runs a chain of filter steps over those bricks only that a change of the
// source can reach. Thread: the Gpu's.
//
// Scratch pools have room for as many bricks as the largest change so far needed. They are kept for the next change,
// which uses their slots from the first one on.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/bricks/brick_reach.hpp"
#include "engine/filter_passes/filter_dispatch.hpp"
#include "engine/filter_passes/filter_route.hpp"
#include "engine/filter_passes/filter_tasks.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/host_list.hpp"
#include "shaders/page_write.layout.h"

namespace palpate {

class FilterRegion {
 public:
  // All arguments must outlive this. `result` holds the chain's result for the source as it was before the first
  // change.
  FilterRegion(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& dispatch, std::span<const FilterRoute> routes,
               const BrickPool& source, BrickPool& result);

  // filter_chain.hpp describes these functions.
  using SourceConstant = std::function<std::optional<float>(std::uint32_t brick)>;
  void plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant);
  [[nodiscard]] std::optional<float> constantAfter(std::uint32_t brick) const;
  void abandon() noexcept;
  void makeKernels();
  void commit();
  void record(gpu::Commands& commands);
  void settle();
  [[nodiscard]] static std::uint32_t dispatchesOf(std::size_t steps) noexcept;  // upper limit for record()
  void prepare();
  [[nodiscard]] std::size_t scratchBytes() const noexcept;

 private:
  // A brick that a step is to write.
  struct OutputBrick {
    std::uint32_t brick = 0;
    std::optional<float> constant;  // empty: it is stored
  };
  // All bricks that one step is to write.
  struct StepOutput {
    std::vector<OutputBrick> bricks;  // ascending
    std::vector<FilterRange> ranges;
    std::uint32_t first_page = 0, page_count = 0;  // range in pages_
    std::size_t stored = 0;                        // bricks that are not constant
  };

  [[nodiscard]] std::vector<StepOutput> outputsOf(std::span<const std::uint32_t> bricks,
                                                  const SourceConstant& source_constant) const;
  void findConstants(std::size_t step, std::vector<StepOutput>& outputs, const SourceConstant& source_constant) const;
  [[nodiscard]] static const OutputBrick* find(const StepOutput& output, std::uint32_t brick);  // null: not in it
  [[nodiscard]] std::size_t newBricks(const StepOutput& last) const;
  void handOutScratch(const StepOutput& output);
  void handOutResult(const StepOutput& output);
  void listTasks(std::size_t step);
  BrickPool& scratch(std::size_t i);
  [[nodiscard]] const BrickPool& readBy(std::size_t step) const;
  [[nodiscard]] const BrickPool& writtenBy(std::size_t step) const;
  [[nodiscard]] bool inPlaceFollows(std::size_t step) const noexcept;

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  FilterDispatch& dispatch_;
  std::span<const FilterStep> steps_;
  std::span<const FilterRoute> routes_;
  const BrickPool& source_;
  BrickPool& result_;
  BrickGrid grid_;
  gpu::Kernel page_kernel_;
  std::array<std::unique_ptr<BrickPool>, FilterRoute::kResult> scratch_;
  std::vector<StepOutput> outputs_;
  std::vector<layout::FilterTask> tasks_;
  std::vector<layout::PageWrite> pages_;
  HostList<layout::FilterTask> task_list_;
  HostList<layout::PageWrite> page_list_;
};

}  // namespace palpate
