// SPDX-License-Identifier: Apache-2.0
// engine/draw/cell_tree.hpp: which cells of a volume an isosurface crosses, on the GPU, for rays to find it quickly
// (shaders/cell_tree.layout.h). It depends on the densities and the isovalue alone, not on how the volume came to be.
//
// Memory: 4 bytes for each brick of the domain, 64 for each brick that the isosurface has crossed. Thread: the Gpu's.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/host_list.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/cell_tree.layout.h"

namespace palpate {

class CellTree {
 public:
  // Of the pool as it is now; `bounds` are up to date. Blocks. Cost: a look at every brick and at every voxel of those
  // that the isosurface crosses. Throws Error(kOutOfMemory).
  CellTree(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds,
           float isovalue);

  // Makes room for the blocks of as many more bricks. Not while submitted work uses the tree. Throws
  // Error(kOutOfMemory).
  void reserve(std::size_t bricks);
  // Records the work that brings the tree up to date where bounds or densities changed: in `bricks`, with all bricks
  // whose cells end at changed voxels (kBoundsReach). After reserve() for as many. The list is read when that work
  // runs.
  void record(gpu::Commands& commands, std::span<const std::uint32_t> bricks);

  [[nodiscard]] std::uint32_t levels() const noexcept { return levels_; }
  [[nodiscard]] float isovalue() const noexcept { return isovalue_; }
  [[nodiscard]] const gpu::Buffer& tree() const noexcept { return *tree_; }
  [[nodiscard]] const gpu::Buffer& blocks() const noexcept { return *blocks_; }
  [[nodiscard]] std::size_t bytes() const noexcept { return tree_->bytes() + blocks_->bytes(); }

  // The most dispatches that record() makes.
  static constexpr std::uint32_t kMostDispatches = 2 + CELL_TREE_LEVELS;

 private:
  struct NodeBox {
    Vec3i first, last;  // bricks
  };
  [[nodiscard]] layout::CellTreePush push(std::size_t count, bool listed) const noexcept;
  void recordSlots(gpu::Commands& commands, std::size_t count, bool listed);
  void recordBlocks(gpu::Commands& commands, std::size_t count, bool listed);
  void recordNodes(gpu::Commands& commands, const NodeBox& box);
  [[nodiscard]] std::vector<const gpu::Buffer*> bindings() const;
  [[nodiscard]] std::uint32_t slotsInUse() const;

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const BrickBoundsPass& bounds_;
  float isovalue_;
  std::uint32_t levels_;
  PoolKernel slots_kernel_, blocks_kernel_, nodes_kernel_;
  std::optional<gpu::Buffer> tree_, blocks_;
  std::size_t slots_at_most_ = 0;  // in use
  HostList<std::uint32_t> list_;
  gpu::Commands commands_;
};

// Levels of the tree of a domain: the fewest whose top has at most two nodes along each axis, from 1 to
// CELL_TREE_LEVELS.
[[nodiscard]] std::uint32_t cellTreeLevels(const layout::PoolDomain& domain) noexcept;

}  // namespace palpate
