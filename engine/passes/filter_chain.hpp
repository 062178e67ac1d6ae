// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_chain.hpp: runs a chain of filter steps over a brick pool into another pool
// (shaders/filter_*.comp), as a whole, or after an edit only where the result can have changed. Twin:
// engine/reference/filter.hpp.
//
// A brick whose every neighbour within reach holds one and the same density gets one too, and no storage, so sparse
// volumes stay sparse; a distance has storage only next to the isosurface (distance_bricks.hpp), and in regions that
// were recomputed where the source has any. Steps go back and forth between scratch pools (filter_route.hpp). A result
// is a function of the source alone, so recomputing a region gives the bits that computing all gives. Memory: result
// and scratch, each at most 2 KiB a brick that is not constant, out of the source's budget; a whole run's scratch is
// freed when it ends, a region's is kept for the next. Thread: the Gpu's.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/edit/edit_reach.hpp"
#include "engine/filter/filter_step.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/distance_bricks.hpp"
#include "engine/passes/filter_route.hpp"
#include "engine/passes/filter_tasks.hpp"
#include "engine/passes/host_list.hpp"
#include "shaders/page_write.layout.h"

namespace palpate {

class FilterChain {
 public:
  // At least one step. `source` outlives the chain.
  FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps);

  // All bricks; blocks. `progress` gets the fraction done, some thousand bricks apart, and may throw to cancel: the
  // result then holds nothing of use. Throws Error(kOutOfMemory).
  void run(const std::function<void(double)>& progress = {});

  [[nodiscard]] const BrickPool& result() const noexcept { return *result_; }
  [[nodiscard]] const std::vector<FilterStep>& steps() const noexcept { return steps_; }
  [[nodiscard]] const Vec3i& reach() const noexcept { return reach_; }  // of the whole chain [voxel]
  [[nodiscard]] std::size_t scratchBytes() const noexcept;              // that is kept on the GPU

  // After a change of the source, the result's bricks that it can reach are computed anew:
  //   plan()    finds out which bricks each step needs and makes room. `bricks`: the result's, ascending.
  //             `source_constant(b)`: the one density that source brick b will hold, or nothing if it will be stored.
  //             Throws Error(kOutOfMemory); nothing has changed then.
  //   commit()  hands out slots, once the source's pages are right: result() then says where its bricks will be.
  //   record()  the work, to follow the source's.
  //   settle()  when it is done and the source has settled: frees storage of bricks that need none any more.
  using SourceConstant = std::function<std::optional<float>(std::uint32_t brick)>;
  void plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant);
  // What a brick of the result will hold everywhere once what was planned is done, or nothing if it will be stored: a
  // SourceConstant for a chain behind this one.
  [[nodiscard]] std::optional<float> constantAfter(std::uint32_t brick) const;
  // Instead of commit(), where there was no room for something else: forgets the plan and frees scratch, which may have
  // taken the room that a smaller change needs.
  void abandon() noexcept;
  void makeKernels();  // for the pools' slabs as they are after plan(); throws Error(kDevice)
  void commit();
  void record(gpu::Commands& commands);
  void settle();
  [[nodiscard]] std::uint32_t dispatches() const noexcept;  // that record() makes at most
  void reserve(std::size_t bricks);  // room in the result for so many more to be stored; throws Error(kOutOfMemory)
  // Makes kernels and scratch of regions ready, so that the first edit does not wait for the driver's compiler.
  void prepare();

 private:
  // What a step is to write in a region.
  struct LevelBrick {
    std::uint32_t brick = 0;
    std::optional<float> constant;
  };
  struct Level {
    std::vector<LevelBrick> bricks;  // ascending
    std::vector<FilterRange> ranges;
    std::uint32_t first_page = 0, page_count = 0;  // pages to write
    std::size_t stored = 0;
  };

  [[nodiscard]] std::vector<layout::BrickPage> pagesAfter(const FilterStep& step, const BrickPool& from) const;
  void findBand(const FilterStep& seed, const BrickPool& densities);
  void runStep(std::size_t step, const BrickPool& from, BrickPool& to, const std::function<void(double)>& progress);
  [[nodiscard]] std::vector<Level> levelsOf(std::span<const std::uint32_t> bricks,
                                            const SourceConstant& source_constant) const;
  void findConstants(std::size_t step, std::vector<Level>& levels, const SourceConstant& source_constant) const;
  [[nodiscard]] static const LevelBrick* find(const Level& level, std::uint32_t brick);  // null: not in it
  [[nodiscard]] std::size_t newBricks(const Level& last) const;
  void handOutScratch(const Level& level);
  void handOutResult(const Level& level);
  void listTasks(std::size_t step);
  void dispatch(gpu::Commands& commands, std::size_t step, const BrickPool& from, const BrickPool& to,
                const gpu::Buffer& tasks, std::span<const FilterRange> ranges);
  const gpu::Kernel& kernelOf(const FilterStep& step, const BrickPool& from, bool edge);
  BrickPool& scratch(std::size_t i);
  [[nodiscard]] const BrickPool& readBy(std::size_t step) const;
  [[nodiscard]] const BrickPool& writtenBy(std::size_t step) const;
  [[nodiscard]] bool inPlaceFollows(std::size_t step) const noexcept;

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& source_;
  BrickGrid grid_;
  std::vector<FilterStep> steps_;
  std::vector<FilterRoute> routes_;
  Vec3i reach_;
  std::vector<layout::BrickPage> band_;  // pages of the distance that is under way: distanceBricks
  std::vector<gpu::Buffer> taps_;        // of each step
  std::unique_ptr<BrickPool> result_;
  std::map<std::string, gpu::Kernel> kernels_;  // by name and constants
  gpu::Kernel page_kernel_;
  // of regions
  std::array<std::unique_ptr<BrickPool>, FilterRoute::kResult> scratch_;
  std::vector<Level> levels_;
  std::vector<layout::FilterTask> tasks_;
  std::vector<layout::PageWrite> pages_;
  HostList<layout::FilterTask> task_list_;
  HostList<layout::PageWrite> page_list_;
};

}  // namespace palpate
