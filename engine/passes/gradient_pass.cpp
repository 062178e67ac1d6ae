// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/gradient_pass.hpp"

#include <algorithm>

#include "engine/passes/tuning.hpp"

namespace palpate {
namespace {

layout::GradientPush pushFor(const BrickPool& pool, const TaskRange& range, const SampleFormat& format,
                             const layout::IsovaluePair& isovalues) {
  const Vec3& h = pool.lattice().spacing_m;
  const auto inverse = [](double length_m) { return static_cast<float>(1.0 / length_m); };
  return {pool.domain(),         range.first,           range.count,    inverse(2.0 * h.x()), inverse(2.0 * h.y()),
          inverse(2.0 * h.z()),  inverse(h.x()),        inverse(h.y()), inverse(h.z()),       inverse(12.0 * h.x()),
          inverse(12.0 * h.y()), inverse(12.0 * h.z()), isovalues,      format.code};
}

// Which kernel computes an operator: a new stencil is a line here.
struct GradientKernel {
  const char* name;
  std::uint32_t bindings;
  std::uint32_t bricks_a_group;
};
GradientKernel kernelOf(const GradientOperator& gradient_operator, bool smoothed) {
  if (smoothed) return {"gradient_smoothed", GRADIENT_SMOOTHED_BINDINGS, 1};
  if (gradient_operator.kind.stencil == GRADIENT_SOBEL) return {"gradient_sobel", GRADIENT_BINDINGS, SOBEL_BRICKS};
  if (gradient_operator.kind.stencil == GRADIENT_CENTRAL4) return {"gradient_central4", GRADIENT_BINDINGS, 1};
  return {"gradient", GRADIENT_BINDINGS, 1};
}

std::vector<std::uint32_t> constantsOf(const SampleStore& store, const Tuning& tuning, GradientUse use) {
  const bool is_short = use == GradientUse::kOnce && store.brickCount() <= tuning.short_gradient_bricks;
  const std::uint32_t run = is_short ? tuning.short_gradient_run : tuning.gradient_run;
  return {store.format().half ? 1U : 0U, run, BRICK_ROWS / run};
}

}  // namespace

GradientPass::GradientPass(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& pool, const SampleStore& store,
                           const GradientOperator& gradient_operator, const BrickPool* smoothed, GradientUse use)
    : gpu_(gpu),
      transfer_(transfer),
      pool_(pool),
      store_(store),
      operator_(gradient_operator),
      smoothed_(smoothed),
      kernel_(gpu, kernelOf(gradient_operator, smoothed != nullptr).name, smoothed != nullptr ? *smoothed : pool,
              kernelOf(gradient_operator, smoothed != nullptr).bindings, sizeof(layout::GradientPush),
              constantsOf(store, tuningFor(gpu.info()), use), smoothed != nullptr ? &pool : nullptr) {}

void GradientPass::run(std::span<const std::uint32_t> bricks, const std::function<void(double)>& progress) {
  BrickTasks by_slab;
  for (const std::uint32_t brick : bricks) by_slab.add(brick, store_.place(brick));
  std::vector<layout::BrickTask> list;
  const std::vector<TaskRange> ranges = by_slab.moveTo(list);
  if (ranges.empty()) return;
  const gpu::Buffer tasks(gpu_, "gradient tasks", list.size() * sizeof(layout::BrickTask), gpu::MemoryKind::kDevice);
  transfer_.upload(std::as_bytes(std::span(list)), tasks);
  gpu::Commands commands(gpu_, "gradient", 1);
  const std::uint32_t most = tuningFor(gpu_.info()).gradient_bricks;
  std::size_t done = 0;
  for (const TaskRange& range : ranges) {
    for (std::uint32_t first = 0; first < range.count; first += most) {
      const TaskRange part{range.slab, range.first + first, std::min(range.count - first, most)};
      commands.begin();
      record(commands, tasks, {&part, 1}, {});
      commands.run();
      done += part.count;
      if (progress) progress(static_cast<double>(done) / static_cast<double>(list.size()));
    }
  }
}

void GradientPass::record(gpu::Commands& commands, const gpu::Buffer& tasks, std::span<const TaskRange> ranges,
                          const ActiveTest& test) {
  const gpu::Buffer* bounds = test.bounds != nullptr ? test.bounds : &tasks;  // unused then, but bound
  const std::uint32_t bricks_a_group = kernelOf(operator_, smoothed_ != nullptr).bricks_a_group;
  for (const TaskRange& range : ranges) {
    std::vector<const gpu::Buffer*> buffers =
        poolBindings(smoothed_ != nullptr ? *smoothed_ : pool_, {&tasks, &store_.slab(range.slab), bounds});
    if (smoothed_ != nullptr) {
      const std::vector<const gpu::Buffer*> own = poolBindings(pool_, {});
      buffers.insert(buffers.end(), own.begin(), own.end());
    }
    const std::uint32_t groups = (range.count + bricks_a_group - 1) / bricks_a_group;
    commands.dispatch(kernel_.get(), buffers, gpu::pushBytes(pushFor(pool_, range, store_.format(), test.isovalues)),
                      gpu::Groups::folded(groups, GROUPS_PER_ROW));
  }
}

}  // namespace palpate
