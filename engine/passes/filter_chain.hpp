// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_chain.hpp: runs a chain of filter steps over a brick pool into another pool
// (shaders/filter_*.comp). Twin: engine/reference/filter.hpp.
//
// A brick whose every neighbour within reach holds one and the same density gets one too, and no storage, so sparse
// volumes stay sparse. A distance is worked out in bricks around the isosurface alone. Steps go back and forth between
// two scratch pools (a third where a distance follows other filters), which are freed when a run ends; the last one
// writes the result. Memory: result and scratch, each at most 2 KiB a brick that is not constant, out of the source's
// budget. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/edit/edit_reach.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/distance_bricks.hpp"

namespace palpate {

class FilterChain {
 public:
  // At least one step. `source` outlives the chain.
  FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps);

  // All bricks; blocks. `progress` gets the fraction done before each step, and may throw to cancel: the result then
  // holds nothing of use. Throws Error(kOutOfMemory).
  void run(const std::function<void(double)>& progress = {});

  [[nodiscard]] const BrickPool& result() const noexcept { return *result_; }
  [[nodiscard]] BrickPool& result() noexcept { return *result_; }
  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return steps_; }

 private:
  struct Work;  // of one step

  [[nodiscard]] std::vector<layout::BrickPage> pagesAfter(const FilterStep& step, const BrickPool& from) const;
  void findBand(const FilterStep& seed, const BrickPool& densities);
  void runStep(const FilterStep& step, const BrickPool& from, BrickPool& to);
  void dispatch(gpu::Commands& commands, const FilterStep& step, const BrickPool& from, const BrickPool& to,
                const Work& work);
  const gpu::Kernel& kernelOf(const FilterStep& step, const BrickPool& from, bool edge);

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& source_;
  BrickGrid grid_;
  std::vector<FilterStep> steps_;
  std::unique_ptr<BrickPool> result_;
  std::vector<layout::BrickPage> band_;         // pages of the distance that is under way: distanceBricks
  std::map<std::string, gpu::Kernel> kernels_;  // by name and constants
};

}  // namespace palpate
