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

// The usual number of samples along an edge of a window, which is also the most; fewer where the volume is thinner
// [voxel].
inline constexpr int kWindowEdge = 32;

// Where a window lies.
struct WindowBox {
  Vec3i first = Vec3i::Zero();  // its first voxel in the volume
  Vec3i size = Vec3i::Zero();   // [voxel]
};
// The window around a point, as near to centred on it as the domain allows.
[[nodiscard]] WindowBox windowAround(const Vec3& p_L, const Vec3i& domain, int edge = kWindowEdge);

// How far the place of the window may be from the middle of the last one before a new one is gathered: three sixteenths
// of the edge, six voxels of 32. A window then still has five sixteenths of its edge ahead of that place. A gather for
// every voxel would cost too much.
[[nodiscard]] constexpr int recentreVoxels(int edge) {
  return 3 * edge / 16;
}

// Whether the window of the box `last` still serves where `wish` would be the new box. At the volume's border the box
// stops following the tool, so a window does not serve any more once the new box gets there.
[[nodiscard]] bool stillServes(const WindowBox& last, const WindowBox& wish, const Vec3i& domain,
                               int edge = kWindowEdge);

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
