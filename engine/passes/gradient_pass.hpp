// SPDX-License-Identifier: Apache-2.0
// engine/passes/gradient_pass.hpp: gradients of the stored bricks by one of the operators of engine/gradient
// (shaders/gradient*.comp): spacing aware, one-sided at the volume's border. Twin: engine/reference/gradient.hpp.
// Thread: the Gpu's.
#pragma once

#include <functional>
#include <span>

#include "engine/edit/edit_reach.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/gradient/gradient_operator.hpp"
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
  // `smoothed`: the field whose gradient is taken, for an operator that smooths (a FilterChain of its steps makes it);
  // null: the pool's own.
  GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store,
               const GradientOperator& way = {}, const BrickPool* smoothed = nullptr);

  // How far a changed density changes gradients; of an operator that smooths, how far a smoothed density does.
  [[nodiscard]] Reach reach() const noexcept { return {way_.words.reach, way_.words.reach}; }

  // Every brick of the store; blocks. `progress` gets the fraction done, some thousand bricks apart, and may throw to
  // cancel: the store then holds nothing of use.
  void run(const std::function<void(double)>& progress = {});
  // The bricks of `ranges` in `tasks` (layout::BrickTask).
  void record(gpu::Commands& commands, const gpu::Buffer& tasks, std::span<const TaskRange> ranges,
              const ActiveTest& test);
  void makeKernels() { static_cast<void>(kernel_.get()); }  // for the pool's slabs as they are; throws Error(kDevice)

 private:
  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const SampleStore& store_;
  GradientOperator way_;
  const BrickPool* smoothed_;
  PoolKernel kernel_;
};

}  // namespace palpate
