// SPDX-License-Identifier: Apache-2.0
// engine/passes/brick_bounds_pass.hpp: lowest and highest density of every brick's cells (shaders/brick_bounds.comp).
// Twin: engine/reference/brick_bounds.hpp. Thread: the Gpu's.
#pragma once

#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_pool.hpp"
#include "shaders/brick_bounds.layout.h"

namespace palpate {

class BrickBoundsPass {
 public:
  BrickBoundsPass(gpu::Gpu& gpu, const BrickPool& pool);

  void run();  // all bricks; blocks
  [[nodiscard]] std::vector<layout::BrickBounds> read(gpu::Transfer& transfer) const;
  [[nodiscard]] const gpu::Buffer& bounds() const noexcept { return bounds_; }

 private:
  const BrickPool& pool_;
  gpu::Kernel kernel_;
  gpu::Buffer bounds_;
  gpu::Commands commands_;
};

}  // namespace palpate
