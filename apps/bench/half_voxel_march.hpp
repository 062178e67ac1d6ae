// SPDX-License-Identifier: Apache-2.0
// apps/bench/half_voxel_march.hpp: how Palpate drew the isosurface before it had a cell tree
// (shaders/half_voxel_march.comp, as of commit 5e017c8): in steps of half a voxel, past bricks that cannot hold it. The
// bench keeps it for comparison. Thread: the Gpu's. Blocks.
#pragma once

#include <optional>

#include "base/camera.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/half_voxel_march.layout.h"

namespace palpate {

class HalfVoxelMarch {
 public:
  HalfVoxelMarch(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds);

  void show(const Camera& camera, double isovalue);
  void finish();  // draws it
  [[nodiscard]] RenderedImage image();

 private:
  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const BrickBoundsPass& bounds_;
  PoolKernel kernel_;
  gpu::Commands commands_;
  layout::HalfVoxelMarchPush push_{};
  std::optional<gpu::Buffer> pixels_;
};

}  // namespace palpate
