// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/window_pass.hpp"

#include <algorithm>

namespace palpate {
namespace {

layout::WindowPush pushFor(const BrickPool& pool, const WindowBox& box, const TaskRange& range,
                           const SampleFormat& format, const layout::IsovaluePair& isovalues) {
  const auto first = box.first.cast<layout::uint>().eval();
  const auto size = box.size.cast<layout::uint>().eval();
  return {pool.domain(), range.first, range.count, first.x(), first.y(),           first.z(),
          size.x(),      size.y(),    size.z(),    isovalues, format.readingCode()};
}

}  // namespace

WindowBox windowAround(const Vec3& p_L, const Vec3i& domain, int edge) {
  WindowBox box;
  box.size = domain.cwiseMin(edge);
  for (int axis = 0; axis < 3; ++axis) {
    // Clamped in double first: a tool may be anywhere, even where a voxel number does not fit an int.
    const double wish = p_L[axis] - 0.5 * (box.size[axis] - 1);
    box.first[axis] = static_cast<int>(std::clamp(wish, 0.0, static_cast<double>(domain[axis] - box.size[axis])));
  }
  return box;
}

bool stillServes(const WindowBox& last, const WindowBox& wish, const Vec3i& domain, int edge) {
  const Vec3i farthest = domain - wish.size;
  for (int axis = 0; axis < 3; ++axis) {
    const int first = wish.first[axis];
    if (first != last.first[axis] && (first == 0 || first == farthest[axis])) return false;
  }
  return (wish.first - last.first).cwiseAbs().maxCoeff() < recentreVoxels(edge);
}

WindowPass::WindowPass(gpu::Gpu& gpu, const BrickPool& pool, const SampleStore& store)
    : pool_(pool),
      store_(store),
      kernel_(gpu, "window", pool, WINDOW_BINDINGS, sizeof(layout::WindowPush), {store.format().half ? 1U : 0U}),
      tasks_(gpu, "window tasks", kMaxTasks),
      commands_(gpu, "window", static_cast<std::uint32_t>(kMaxTasks)) {}

void WindowPass::run(const WindowBox& box, const gpu::Buffer& window) {
  std::vector<layout::BrickTask> list;
  const std::vector<TaskRange> ranges = tasksOf(
                                            box, [](std::size_t) { return true; }, [](std::size_t) { return false; })
                                            .moveTo(list);
  commands_.begin();
  tasks_.write(list);
  record(commands_, box, tasks_.buffer(), ranges, {}, window);
  commands_.run();
}

void WindowPass::record(gpu::Commands& commands, const WindowBox& box, const gpu::Buffer& tasks,
                        std::span<const TaskRange> ranges, const ActiveTest& test, const gpu::Buffer& window) {
  const gpu::Buffer* bounds = test.bounds != nullptr ? test.bounds : &tasks;  // unused then, but bound
  for (const TaskRange& range : ranges) {
    commands.dispatch(kernel_.get(), poolBindings(pool_, {&tasks, &store_.slab(range.slab), &window, bounds}),
                      gpu::pushBytes(pushFor(pool_, box, range, store_.format(), test.isovalues)), {range.count, 1});
  }
}

}  // namespace palpate
