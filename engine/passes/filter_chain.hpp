// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_chain.hpp: runs a chain of filter steps over a brick pool into another pool
// (shaders/filter_*.comp), as a whole (filter_whole.hpp), or after an edit only where the result can have changed
// (filter_region.hpp). Twin: engine/reference/filter.hpp.
//
// A brick whose every neighbour within reach holds one and the same density gets one too, and no storage, so sparse
// volumes stay sparse; a distance has storage only next to the isosurface (distance_bricks.hpp), and in regions that
// were recomputed where the source has any. Steps go back and forth between scratch pools (filter_route.hpp). A result
// is a function of the source alone, so recomputing a region gives the bits that computing all gives. Memory: result
// and scratch, each at most 2 KiB a brick that is not constant, out of the source's budget. A whole run's scratch is as
// large as the field and freed when it ends; a region's is another, as large as the largest change, and kept for the
// next. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/filter/filter_step.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/filter_dispatch.hpp"
#include "engine/passes/filter_region.hpp"
#include "engine/passes/filter_route.hpp"

namespace palpate {

// Of a chain: each makes a dispatch or more of an edit's one submission. The longest diffusion has half as many.
inline constexpr std::size_t kMostFilterSteps = 1000;

class FilterChain {
 public:
  // At least one step. `source` outlives the chain. Throws Error(kBadInput) beyond kMostFilterSteps.
  FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps);
  FilterChain(const FilterChain&) = delete;
  FilterChain& operator=(const FilterChain&) = delete;

  // All bricks; blocks. `progress` gets the fraction done, some thousand bricks apart, and may throw to cancel: the
  // result then holds nothing of use. Throws Error(kOutOfMemory).
  void run(const std::function<void(double)>& progress = {});

  [[nodiscard]] const BrickPool& result() const noexcept { return *result_; }
  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return dispatch_.steps(); }
  [[nodiscard]] const Vec3i& reach() const noexcept { return reach_; }  // of the whole chain [voxel]
  [[nodiscard]] std::size_t scratchBytes() const noexcept { return region_.scratchBytes(); }  // that is kept on the GPU

  // After a change of the source, the result's bricks that it can reach are computed anew:
  //   plan()    finds out which bricks each step needs and makes room. `bricks`: the result's, ascending.
  //             `source_constant(b)`: the one density that source brick b will hold, or nothing if it will be stored.
  //             Throws Error(kOutOfMemory); nothing has changed then.
  //   commit()  hands out slots, once the source's pages are right: result() then says where its bricks will be.
  //   record()  the work, to follow the source's.
  //   settle()  when it is done and the source has settled: frees storage of bricks that need none any more.
  using SourceConstant = FilterRegion::SourceConstant;
  void plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant) {
    region_.plan(bricks, source_constant);
  }
  // What a brick of the result will hold everywhere once what was planned is done, or nothing if it will be stored: a
  // SourceConstant for a chain behind this one.
  [[nodiscard]] std::optional<float> constantAfter(std::uint32_t brick) const { return region_.constantAfter(brick); }
  // Instead of commit(), where there was no room for something else: forgets the plan and frees scratch, which may have
  // taken the room that a smaller change needs.
  void abandon() noexcept { region_.abandon(); }
  void makeKernels() { region_.makeKernels(); }  // for the pools' slabs as they are after plan(); throws Error(kDevice)
  void commit() { region_.commit(); }
  void record(gpu::Commands& commands) { region_.record(commands); }
  void settle() { region_.settle(); }
  [[nodiscard]] std::uint32_t dispatches() const noexcept { return region_.dispatches(); }  // of record(), at most
  void reserve(std::size_t bricks);  // room in the result for so many more to be stored; throws Error(kOutOfMemory)
  // Makes kernels and scratch of regions ready, so that the first edit does not wait for the driver's compiler.
  void prepare() { region_.prepare(); }

 private:
  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& source_;
  FilterDispatch dispatch_;
  std::vector<FilterRoute> routes_;
  Vec3i reach_;
  std::unique_ptr<BrickPool> result_;
  FilterRegion region_;
};

// A chain that has run, or null where there are no steps. As FilterChain's constructor and run().
[[nodiscard]] std::unique_ptr<FilterChain> filteredBy(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source,
                                                      std::vector<FilterStep> steps,
                                                      const std::function<void(double)>& progress = {});

}  // namespace palpate
