// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_chain.hpp: runs a chain of filter steps from one brick pool into another
// (shaders/filter_*.comp). It computes the whole field (filter_whole.hpp) or, after an edit, only the bricks whose
// result can have changed (filter_region.hpp). Twin: engine/reference/filter.hpp.
//
// Sparse volumes stay sparse. If the field holds one density everywhere within reach of a brick, the brick's result is
// constant and needs no storage (constant_bricks.hpp). A distance has storage only next to the isosurface. In a region
// that was recomputed it also has storage where the source has it. Steps alternate between scratch pools
// (filter_route.hpp). The result depends on the source alone, so a recomputed region equals a whole run, bit for bit.
//
// Memory, out of the source's budget: at most 2 KiB for each brick that is not constant, in the result and in each
// scratch pool. The scratch of a whole run may be as large as the field; it is freed when the run ends. The scratch of
// regions is as large as the largest change so far; it is kept. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/filter/filter_step.hpp"
#include "engine/filter_passes/filter_dispatch.hpp"
#include "engine/filter_passes/filter_region.hpp"
#include "engine/filter_passes/filter_route.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"

namespace palpate {

// Limit of a chain's steps. After an edit each step needs at least one dispatch, and all go into one submission. The
// longest diffusion has half as many steps.
inline constexpr std::size_t kMostFilterSteps = 1000;

class FilterChain {
 public:
  // `steps`: at least one. `source` must outlive the chain. Throws Error(kBadInput) beyond kMostFilterSteps.
  FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps);
  FilterChain(const FilterChain&) = delete;
  FilterChain& operator=(const FilterChain&) = delete;

  // Computes all bricks. Blocks. `progress` gets the fraction done after every submission (submission_size.hpp). It may
  // throw to cancel; the content of the result is then undefined. Throws Error(kOutOfMemory).
  void run(const std::function<void(double)>& progress = {});

  [[nodiscard]] const BrickPool& result() const noexcept { return *result_; }
  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return dispatch_.steps(); }
  [[nodiscard]] const Vec3i& reach() const noexcept { return reach_; }  // of the whole chain [voxel]
  [[nodiscard]] std::size_t scratchBytes() const noexcept {
    return region_ ? region_->scratchBytes() : 0;
  }  // kept on the GPU

  // After a change of the source, four calls recompute the bricks of the result that the change can reach:
  //   plan()    finds the bricks that each step needs and makes room. `bricks`: those of the result, ascending.
  //             `source_constant(b)`: the one density that source brick b will hold; empty if it will be stored.
  //             Throws Error(kOutOfMemory); then nothing has changed.
  //   commit()  hands out slots. The source's pages must be current. result() then has its new pages.
  //   record()  records the work, after that of the source.
  //   settle()  frees the storage of bricks that became constant. The work must be done and the source settled.
  using SourceConstant = FilterRegion::SourceConstant;
  void plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant) {
    region().plan(bricks, source_constant);
  }
  // The one density that a brick of the result will hold once the plan is carried out; empty if it will be stored. A
  // chain that reads this one's result takes it as its SourceConstant.
  [[nodiscard]] std::optional<float> constantAfter(std::uint32_t brick) const { return region_->constantAfter(brick); }
  // Call it instead of commit() if another part of the edit found no room. Forgets the plan and frees the scratch, so
  // that a smaller change may find room.
  void abandon() noexcept {
    if (region_) region_->abandon();
  }
  void makeKernels() { region().makeKernels(); }  // after plan(), which adds slabs; throws Error(kDevice)
  void commit() { region().commit(); }
  void record(gpu::Commands& commands) { region().record(commands); }
  void settle() { region().settle(); }
  [[nodiscard]] std::uint32_t dispatches() const noexcept {  // upper limit for record()
    return FilterRegion::dispatchesOf(steps().size());
  }
  void reserve(std::size_t bricks);  // room for so many more stored bricks in the result; throws Error(kOutOfMemory)
  // Makes the kernels and scratch pools for edits, so that the first edit does not wait for the driver's compiler.
  void prepare() { region().prepare(); }

 private:
  [[nodiscard]] FilterRegion& region();

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& source_;
  FilterDispatch dispatch_;
  std::vector<FilterRoute> routes_;
  Vec3i reach_;
  std::unique_ptr<BrickPool> result_;
  std::unique_ptr<FilterRegion> region_;  // from the first change on
};

// A chain that has run; null if `steps` is empty. Throws as FilterChain's constructor and run() do.
[[nodiscard]] std::unique_ptr<FilterChain> filteredBy(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source,
                                                      std::vector<FilterStep> steps,
                                                      const std::function<void(double)>& progress = {});

}  // namespace palpate
