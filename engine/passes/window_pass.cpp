// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/window_pass.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/passes/pool_kernel.hpp"

namespace palpate {
namespace {

// A window that starts anywhere touches at most 32 / 8 + 1 bricks along each axis.
constexpr std::size_t kBricksAlong = kWindowEdge / kBrickSize + 1;
constexpr std::size_t kMaxTasks = kBricksAlong * kBricksAlong * kBricksAlong;

struct SlabTasks {
  std::uint32_t slab = 0;
  std::vector<layout::BrickTask> tasks;
};

// The window's bricks by sample slab; bricks without samples join the first list.
std::vector<SlabTasks> tasksOf(const WindowBox& box, const BrickPool& pool, const SampleStore& store) {
  std::vector<SlabTasks> lists(1);
  const Vec3i counts = pool.brickCounts();
  const Vec3i low = box.first / kBrickSize;
  const Vec3i high = (box.first + box.size - Vec3i::Ones()) / kBrickSize;
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const std::size_t brick = (static_cast<std::size_t>(z) * counts.y() + y) * counts.x() + x;
        const SampleStore::Place place = store.place(brick);
        auto list = std::find_if(lists.begin(), lists.end(), [&](const auto& l) { return l.slab == place.slab; });
        if (list == lists.end()) list = lists.insert(lists.end(), SlabTasks{place.slab, {}});
        list->tasks.push_back({static_cast<layout::uint>(brick), place.slot});
      }
    }
  }
  return lists;
}

layout::WindowPush pushFor(const BrickPool& pool, const WindowBox& box, std::size_t first_task, std::size_t count) {
  const auto first = box.first.cast<layout::uint>().eval();
  const auto size = box.size.cast<layout::uint>().eval();
  return {pool.domain(),
          static_cast<layout::uint>(first_task),
          static_cast<layout::uint>(count),
          first.x(),
          first.y(),
          first.z(),
          size.x(),
          size.y(),
          size.z()};
}

}  // namespace

WindowBox windowAround(const Vec3& p_L, const Vec3i& domain) {
  WindowBox box;
  box.size = domain.cwiseMin(kWindowEdge);
  for (int axis = 0; axis < 3; ++axis) {
    // Clamped in double first: a tool may be anywhere, even where a voxel number does not fit an int.
    const double wish = p_L[axis] - 0.5 * (box.size[axis] - 1);
    box.first[axis] = static_cast<int>(std::clamp(wish, 0.0, static_cast<double>(domain[axis] - box.size[axis])));
  }
  return box;
}

WindowPass::WindowPass(gpu::Gpu& gpu, const BrickPool& pool, const SampleStore& store)
    : pool_(pool),
      store_(store),
      kernel_(makePoolKernel(gpu, "window", pool, WINDOW_BINDINGS, sizeof(layout::WindowPush))),
      tasks_(gpu, "window tasks", kMaxTasks * sizeof(layout::BrickTask), gpu::MemoryKind::kHost),
      commands_(gpu, "window", static_cast<std::uint32_t>(std::min(kMaxTasks, store.slabCount() + 1))) {}

void WindowPass::run(const WindowBox& box, const gpu::Buffer& window) {
  auto* tasks = static_cast<layout::BrickTask*>(tasks_.mapped());
  std::size_t first = 0;
  commands_.begin();
  for (const SlabTasks& list : tasksOf(box, pool_, store_)) {
    if (list.tasks.empty()) continue;
    std::memcpy(tasks + first, list.tasks.data(), list.tasks.size() * sizeof(layout::BrickTask));
    commands_.dispatch(kernel_, poolBindings(pool_, {&tasks_, &store_.slab(list.slab), &window}),
                       gpu::pushBytes(pushFor(pool_, box, first, list.tasks.size())),
                       {static_cast<std::uint32_t>(list.tasks.size()), 1});
    first += list.tasks.size();
  }
  commands_.run();
}

}  // namespace palpate
