// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_whole.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "base/portion_size.hpp"
#include "base/stopwatch.hpp"
#include "engine/filter_passes/constant_bricks.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/tuning.hpp"

namespace palpate {
namespace {

class Run {
 public:
  Run(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& steps, const BrickPool& source)
      : gpu_(gpu),
        transfer_(transfer),
        steps_(steps),
        grid_(source.grid()),
        most_bricks_(tuningFor(gpu.info()).filter_bricks) {}

  void step(std::size_t step, const BrickPool& from, BrickPool& to, const std::function<void(double)>& progress) {
    progress(0);
    if (steps_.steps()[step].kind == StepKind::kDistanceSeed) findBand(steps_.steps()[step], from);
    to.assign(transfer_, pagesAfter(steps_.steps()[step], from));
    FilterTasks by_range(grid_, steps_.steps()[step], steps_.hasEdge(step));
    for (std::uint32_t brick = 0; brick < to.brickCount(); ++brick) {
      if (to.isStored(brick)) by_range.add(brick, to.page(brick).slot);
    }
    std::vector<layout::FilterTask> list;
    const std::vector<FilterRange> ranges = by_range.moveTo(list);
    if (list.empty()) return;
    const gpu::Buffer tasks(gpu_, "filter tasks", list.size() * sizeof(layout::FilterTask), gpu::MemoryKind::kDevice);
    transfer_.upload(std::as_bytes(std::span(list)), tasks);
    gpu::Commands commands(gpu_, "filter", 1);
    std::uint32_t done = 0;
    PortionSize size(most_bricks_);
    for (const FilterRange& range : ranges) {
      FilterRange part = range;
      for (std::uint32_t first = 0; first < range.count; first += part.count) {
        part.first = range.first + first;
        part.count = std::min(range.count - first, size.bricks());
        const Stopwatch watch;
        commands.begin();
        steps_.record(commands, step, from, to, tasks, {&part, 1});
        commands.run();
        size.took(part.count, watch.seconds());
        done += part.count;
        progress(static_cast<double>(done) / static_cast<double>(list.size()));
      }
    }
  }

 private:
  void findBand(const FilterStep& seed, const BrickPool& densities) {
    BrickBoundsPass bounds(gpu_, densities);
    bounds.run();
    band_ = distanceBricks(seed, bounds.read(transfer_), densities.grid());
  }

  [[nodiscard]] std::vector<layout::BrickPage> pagesAfter(const FilterStep& step, const BrickPool& from) const {
    if (step.kind == StepKind::kDistanceFinish) return band_;  // same slots as the spread before
    if (step.kind == StepKind::kDistanceSeed || step.kind == StepKind::kDistanceSpread) {
      std::vector<layout::BrickPage> pages = band_;
      for (layout::BrickPage& page : pages) page.constant = uniformResult(step, page.constant);
      return pages;
    }
    std::vector<layout::BrickPage> pages(from.brickCount(), {0, 0.0F});
    const Vec3i ring = ringOf(step);
    const auto constantOf = [&](std::uint32_t brick) { return from.constantOf(brick); };
    std::optional<std::pair<std::uint32_t, float>> last;  // neighbours often hold the same density
    for (std::uint32_t brick = 0; brick < pages.size(); ++brick) {
      const std::optional<float> density = uniformAround(grid_, brick, ring, constantOf);
      if (!density) continue;
      const auto bits = std::bit_cast<std::uint32_t>(*density);
      if (!last || last->first != bits) last = {bits, uniformResult(step, *density)};
      pages[brick] = {NO_SLOT, last->second};
    }
    return pages;
  }

  gpu::Gpu& gpu_;
  gpu::Transfer& transfer_;
  FilterDispatch& steps_;
  BrickGrid grid_;
  std::uint32_t most_bricks_;            // of a submission
  std::vector<layout::BrickPage> band_;  // distanceBricks() of the present distance
};

}  // namespace

void filterWhole(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& steps, std::span<const FilterRoute> routes,
                 const BrickPool& source, BrickPool& result, const std::function<void(double)>& progress) {
  std::array<std::unique_ptr<BrickPool>, FilterRoute::kResult> scratch;
  const auto poolOf = [&](std::size_t i) -> BrickPool& {
    if (i == FilterRoute::kResult) return result;
    if (!scratch[i]) scratch[i] = std::make_unique<BrickPool>(gpu, transfer, source, "filter scratch");
    return *scratch[i];
  };
  Run run(gpu, transfer, steps, source);
  for (std::size_t i = 0; i < routes.size(); ++i) {
    const int read = routes[i].from;
    const BrickPool& from = read == FilterRoute::kSource ? source : poolOf(routes[static_cast<std::size_t>(read)].pool);
    run.step(i, from, poolOf(routes[i].pool), [&](double part) {
      if (progress) progress((static_cast<double>(i) + part) / static_cast<double>(routes.size()));
    });
  }
}

}  // namespace palpate
