// SPDX-License-Identifier: Apache-2.0
// engine/passes/window_pass.hpp: gathers the samples around the tool into a small dense box, the window
// (shaders/window.comp), in memory that the servo reads. Twin: engine/reference/window.hpp. Thread: the Gpu's.
#pragma once

#include <span>
#include <vector>

#include "engine/gpu/commands.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/brick_tasks.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/host_list.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "engine/passes/sample_store.hpp"
#include "shaders/window.layout.h"

namespace palpate {

inline constexpr int kWindowEdge = 32;  // samples along an edge, fewer where the volume is thinner [voxel]

// Where a window lies.
struct WindowBox {
  Vec3i first = Vec3i::Zero();  // its first voxel in the volume
  Vec3i size = Vec3i::Zero();   // [voxel]
};
// The window around a point, as near to centred on it as the domain allows.
[[nodiscard]] WindowBox windowAround(const Vec3& p_L, const Vec3i& domain);

class WindowPass {
 public:
  WindowPass(gpu::Gpu& gpu, const BrickPool& pool, const SampleStore& store);

  // Fills `window`, kHost memory with room for the box's samples. Blocks; on lavapipe for about half a millisecond.
  void run(const WindowBox& box, const gpu::Buffer& window);

  // The same as part of other work. tasksOf() lists the bricks of a box for which `wanted(brick)` is true; record()
  // gathers them. `if_active(brick)`: whether the kernel must look at the brick's bounds to see if it has samples.
  template <typename Wanted, typename IfActive>
  [[nodiscard]] BrickTasks tasksOf(const WindowBox& box, const Wanted& wanted, const IfActive& if_active) const;
  void record(gpu::Commands& commands, const WindowBox& box, const gpu::Buffer& tasks,
              std::span<const TaskRange> ranges, const ActiveTest& test, const gpu::Buffer& window);
  void makeKernels() { static_cast<void>(kernel_.get()); }  // for the pool's present slabs; throws Error(kDevice)

  // A window that starts anywhere touches at most 32 / 8 + 1 bricks along each axis.
  static constexpr std::size_t kBricksAlong = kWindowEdge / kBrickSize + 1;
  static constexpr std::size_t kMaxTasks = kBricksAlong * kBricksAlong * kBricksAlong;

 private:
  const BrickPool& pool_;
  const SampleStore& store_;
  PoolKernel kernel_;
  HostList<layout::BrickTask> tasks_;
  gpu::Commands commands_;
};

template <typename Wanted, typename IfActive>
BrickTasks WindowPass::tasksOf(const WindowBox& box, const Wanted& wanted, const IfActive& if_active) const {
  BrickTasks tasks;
  const BrickGrid grid = pool_.grid();
  grid.forEachIn({box.first, box.first + box.size - Vec3i::Ones()}, [&](const Vec3i& at) {
    const std::uint32_t brick = grid.index(at);
    if (wanted(brick)) tasks.add(brick, store_.place(brick), store_.has(brick) && if_active(brick));
  });
  return tasks;
}

}  // namespace palpate
