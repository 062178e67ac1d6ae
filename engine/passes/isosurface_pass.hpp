// SPDX-License-Identifier: Apache-2.0
// engine/passes/isosurface_pass.hpp: draws the isosurface (shaders/isosurface.comp) and skips bricks that cannot hold
// it. Twin of its depth: engine/reference/isosurface.hpp. Thread: the Gpu's. Blocks; cost on lavapipe: about a second a
// megapixel.
#pragma once

#include <functional>

#include "base/camera.hpp"
#include "base/rendered_image.hpp"
#include "engine/gpu/commands.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/isosurface.layout.h"

namespace palpate {

class IsosurfacePass {
 public:
  IsosurfacePass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const BrickBoundsPass& bounds);

  // `between` is called between bands of rows and may throw to cancel.
  [[nodiscard]] RenderedImage draw(const Camera& camera, double isovalue, const std::function<void()>& between = {});

 private:
  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  const BrickPool& pool_;
  const BrickBoundsPass& bounds_;
  PoolKernel kernel_;
  gpu::Commands commands_;
};

}  // namespace palpate
