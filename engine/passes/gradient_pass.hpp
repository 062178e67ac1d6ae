// SPDX-License-Identifier: Apache-2.0
// engine/passes/gradient_pass.hpp: central-difference gradients of the stored bricks (shaders/gradient.comp): spacing
// aware, one-sided at the volume's border. Twin: engine/reference/gradient.hpp. Thread: the Gpu's.
#pragma once

#include <span>

#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/brick_tasks.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/gradient.layout.h"

namespace palpate {

// What decides on the GPU whether a brick is active: the bounds of all bricks, and the isovalue.
struct ActiveTest {
  const gpu::Buffer* bounds = nullptr;  // layout::BrickBounds; null: no task says IF_ACTIVE
  float isovalue = 0;                   // [density]
};

class GradientPass {
 public:
  GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store);

  void run();  // every brick of the store; blocks
  // The bricks of `ranges` in `tasks` (layout::BrickTask).
  void record(gpu::Commands& commands, const gpu::Buffer& tasks, std::span<const TaskRange> ranges,
              const ActiveTest& test);

 private:
  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const SampleStore& store_;
  PoolKernel kernel_;
};

}  // namespace palpate
