// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/gradient_pass.hpp"

namespace palpate {
namespace {

layout::GradientPush pushFor(const BrickPool& pool, const TaskRange& range, float isovalue) {
  const Vec3& h = pool.lattice().spacing_m;
  const auto inverse = [](double length_m) { return static_cast<float>(1.0 / length_m); };
  return {pool.domain(),        range.first,    range.count,    inverse(2.0 * h.x()), inverse(2.0 * h.y()),
          inverse(2.0 * h.z()), inverse(h.x()), inverse(h.y()), inverse(h.z()),       isovalue};
}

}  // namespace

GradientPass::GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      store_(store),
      kernel_(gpu, "gradient", pool, GRADIENT_BINDINGS, sizeof(layout::GradientPush)) {}

void GradientPass::run() {
  BrickTasks by_slab;
  for (const std::uint32_t brick : store_.bricks()) by_slab.add(brick, store_.place(brick));
  std::vector<layout::BrickTask> list;
  const std::vector<TaskRange> ranges = by_slab.moveTo(list);
  if (ranges.empty()) return;
  const gpu::Buffer tasks(gpu_, "gradient tasks", list.size() * sizeof(layout::BrickTask), gpu::MemoryKind::kDevice);
  transfer_.upload(std::as_bytes(std::span(list)), tasks);
  gpu::Commands commands(gpu_, "gradient", static_cast<std::uint32_t>(ranges.size()));
  commands.begin();
  record(commands, tasks, ranges, {});
  commands.run();
}

void GradientPass::record(gpu::Commands& commands, const gpu::Buffer& tasks, std::span<const TaskRange> ranges,
                          const ActiveTest& test) {
  const gpu::Buffer* bounds = test.bounds != nullptr ? test.bounds : &tasks;  // unused then, but bound
  for (const TaskRange& range : ranges) {
    commands.dispatch(kernel_.get(), poolBindings(pool_, {&tasks, &store_.slab(range.slab), bounds}),
                      gpu::pushBytes(pushFor(pool_, range, test.isovalue)),
                      gpu::Groups::folded(range.count, GROUPS_PER_ROW));
  }
}

}  // namespace palpate
