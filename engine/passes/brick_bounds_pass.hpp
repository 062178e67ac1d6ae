// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_bounds_pass.hpp: finds the lowest and highest density over the cells that begin in each brick
// (shaders/brick_bounds.comp), for all bricks or for listed ones. Twin: engine/reference/brick_bounds.hpp. Thread: the
// Gpu's.
#pragma once

#include <optional>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

class BrickBoundsPass {
 public:
  BrickBoundsPass(gpu::Gpu& gpu, const BrickPool& pool);

  void run();  // all bricks; blocks
  // Records the first `count` bricks of `tasks` (layout::BrickTask). Their bounds also go into `results`
  // (layout::BrickBounds), in the order of the tasks.
  void record(gpu::Commands& commands, const gpu::Buffer& tasks, std::uint32_t count, const gpu::Buffer& results);
  // Makes the kernel for listed bricks, for the pool's present slabs; throws Error(kDevice). Without this the first
  // record() makes it: a field that is not edited needs none.
  void makeKernels();
  [[nodiscard]] std::vector<layout::BrickBounds> read(gpu::Transfer& transfer) const;
  [[nodiscard]] const gpu::Buffer& bounds() const noexcept { return bounds_; }

 private:
  gpu::Gpu& gpu_;
  const BrickPool& pool_;
  PoolKernel all_;
  std::optional<PoolKernel> listed_;
  gpu::Buffer bounds_;
  gpu::Commands commands_;
};

}  // namespace palpate
