// SPDX-License-Identifier: Apache-2.0
// engine/passes/gradient_pass.hpp: computes the samples (gradient, density) of the bricks in a SampleStore, by one of
// the operators of engine/gradient (shaders/gradient*.comp). Twin: engine/reference/gradient.hpp. Thread: the Gpu's.
#pragma once

#include <functional>
#include <span>

#include "engine/bricks/brick_reach.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/brick_tasks.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/gradient.layout.h"

namespace palpate {

// By this a kernel decides whether a brick is active: the bounds of all bricks, and the isovalues.
struct ActiveTest {
  const gpu::Buffer* bounds = nullptr;  // layout::BrickBounds; null: no task says IF_ACTIVE
  layout::IsovaluePair isovalues = {};
};

class GradientPass {
 public:
  // `smoothed`: the field whose gradient is taken, for an operator that smooths (a FilterChain makes it); null: that of
  // `pool`.
  GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store,
               const GradientOperator& way = {}, const BrickPool* smoothed = nullptr);

  // How far a changed density changes gradients. For an operator that smooths: how far a changed smoothed density does.
  [[nodiscard]] Reach reach() const noexcept { return {way_.words.reach, way_.words.reach}; }

  // Computes every brick of the store, or these, which have slots there; blocks. `progress` gets the fraction done
  // after every Tuning::gradient_bricks bricks. It may throw to cancel; the content of these slots is then undefined.
  void run(const std::function<void(double)>& progress = {}) { run(store_.bricks(), progress); }
  void run(std::span<const std::uint32_t> bricks, const std::function<void(double)>& progress = {});
  // Records the bricks of `ranges` in `tasks` (layout::BrickTask).
  void record(gpu::Commands& commands, const gpu::Buffer& tasks, std::span<const TaskRange> ranges,
              const ActiveTest& test);
  void makeKernels() { static_cast<void>(kernel_.get()); }  // for the pool's present slabs; throws Error(kDevice)

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
