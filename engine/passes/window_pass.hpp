// SPDX-License-Identifier: Apache-2.0
// engine/passes/window_pass.hpp: gathers the samples around the tool into a small dense box (shaders/window.comp),
// written straight into memory that the servo reads. Twin: engine/reference/window.hpp. Thread: the Gpu's.
#pragma once

#include "engine/gpu/commands.hpp"
#include "engine/gpu/kernel.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/window.layout.h"

namespace palpate {

inline constexpr int kWindowEdge = 32;  // samples along an edge, fewer where the volume is thinner [voxel]

// Where a window around a point lies: as near to centred as the domain lets it.
struct WindowBox {
  Vec3i first = Vec3i::Zero();  // voxel of the volume
  Vec3i size = Vec3i::Zero();
};
[[nodiscard]] WindowBox windowAround(const Vec3& p_L, const Vec3i& domain);

class WindowPass {
 public:
  WindowPass(gpu::Gpu& gpu, const BrickPool& pool, const SampleStore& store);

  // Fills `window` (kHost memory of at least the box's samples); blocks. Lavapipe: about half a millisecond.
  void run(const WindowBox& box, const gpu::Buffer& window);

 private:
  const BrickPool& pool_;
  const SampleStore& store_;
  gpu::Kernel kernel_;
  gpu::Buffer tasks_;
  gpu::Commands commands_;
};

}  // namespace palpate
