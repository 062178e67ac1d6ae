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

// A kernel decides with this whether a brick is active.
struct ActiveTest {
  const gpu::Buffer* bounds = nullptr;  // of all bricks (layout::BrickBounds); null: no task has the flag IF_ACTIVE
  layout::IsovaluePair isovalues = {};
};

// Whether a pass serves for long or computes the store's bricks once. Only the time depends on it (Tuning).
enum class GradientUse { kOften, kOnce };

class GradientPass {
 public:
  // `smoothed`: the field whose gradient is taken, for an operator that smooths (a FilterChain makes it); null: that of
  // `pool`.
  GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store,
               const GradientOperator& gradient_operator = {}, const BrickPool* smoothed = nullptr,
               GradientUse use = GradientUse::kOften);

  // How far a changed density changes gradients. For an operator that smooths: how far a changed smoothed density does.
  [[nodiscard]] Reach reach() const noexcept { return {operator_.kind.reach, operator_.kind.reach}; }

  // Computes every brick of the store, or the given bricks, which must have slots there. Blocks. `progress` gets the
  // fraction done after every Tuning::gradient_bricks bricks. It may throw to cancel; the slots' content is then
  // undefined.
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
  GradientOperator operator_;
  const BrickPool* smoothed_;
  PoolKernel kernel_;
};

}  // namespace palpate
