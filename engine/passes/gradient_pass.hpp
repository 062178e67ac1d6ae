// SPDX-License-Identifier: Apache-2.0
// engine/passes/gradient_pass.hpp: central-difference gradients of the stored bricks (shaders/gradient.comp): spacing
// aware, one-sided at the volume's border. Twin: engine/reference/gradient.hpp. Thread: the Gpu's.
#pragma once

#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/gradient.layout.h"

namespace palpate {

class GradientPass {
 public:
  GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store);

  void run();  // every brick of the store; blocks

 private:
  const BrickPool& pool_;
  const SampleStore& store_;
  gpu::Kernel kernel_;
  std::vector<gpu::Buffer> tasks_;  // a list for each slab
  gpu::Commands commands_;
};

}  // namespace palpate
