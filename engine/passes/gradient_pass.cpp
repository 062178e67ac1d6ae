// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/gradient_pass.hpp"

#include <algorithm>
#include <span>

#include "engine/passes/pool_kernel.hpp"

namespace palpate {
namespace {

layout::GradientPush pushFor(const BrickPool& pool, std::size_t task_count) {
  const Vec3& h = pool.lattice().spacing_m;
  const auto inverse = [](double length_m) { return static_cast<float>(1.0 / length_m); };
  return {pool.domain(),        static_cast<layout::uint>(task_count),
          inverse(2.0 * h.x()), inverse(2.0 * h.y()),
          inverse(2.0 * h.z()), inverse(h.x()),
          inverse(h.y()),       inverse(h.z())};
}

}  // namespace

GradientPass::GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store)
    : pool_(pool),
      store_(store),
      kernel_(makePoolKernel(gpu, "gradient", pool, GRADIENT_BINDINGS, sizeof(layout::GradientPush))),
      commands_(gpu, "gradient", static_cast<std::uint32_t>(store.slabCount())) {
  const std::vector<std::uint32_t>& bricks = store.bricks();
  for (std::size_t first = 0; first < bricks.size(); first += BRICKS_PER_SAMPLE_SLAB) {
    const std::size_t count = std::min<std::size_t>(bricks.size() - first, BRICKS_PER_SAMPLE_SLAB);
    std::vector<layout::BrickTask> tasks;
    tasks.reserve(count);
    for (std::size_t i = 0; i < count; ++i) tasks.push_back({bricks[first + i], static_cast<layout::uint>(i)});
    tasks_.emplace_back(gpu, "gradient tasks", count * sizeof(layout::BrickTask), gpu::MemoryKind::kDevice);
    transfer.upload(std::as_bytes(std::span(tasks)), tasks_.back());
  }
}

void GradientPass::run() {
  if (tasks_.empty()) return;
  commands_.begin();
  for (std::size_t slab = 0; slab < tasks_.size(); ++slab) {
    const std::size_t count = tasks_[slab].bytes() / sizeof(layout::BrickTask);
    commands_.dispatch(kernel_, poolBindings(pool_, {&tasks_[slab], &store_.slab(slab)}),
                       gpu::pushBytes(pushFor(pool_, count)),
                       gpu::Groups::folded(static_cast<std::uint32_t>(count), GROUPS_PER_ROW));
  }
  commands_.run();
}

}  // namespace palpate
