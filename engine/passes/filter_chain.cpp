// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/filter_chain.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "engine/passes/filter_kernels.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "shaders/filter.layout.h"
#include "shaders/kernels.hpp"

namespace palpate {
namespace {

bool sameBits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

Vec3i ringOf(const FilterStep& step) {
  return (step.reach.array() + kBrickSize - 1) / kBrickSize;
}

// Whether a step at some voxel of the brick reads beyond the border.
bool atEdge(const BrickGrid& grid, const Vec3i& brick, const FilterStep& step) {
  const Vec3i first = brick * kBrickSize;
  for (int axis = 0; axis < 3; ++axis) {
    if (step.reach[axis] == 0) continue;
    if (first[axis] < step.reach[axis] || first[axis] + kBrickSize - 1 + step.reach[axis] >= grid.size[axis])
      return true;
  }
  return false;
}

// The density that all bricks in reach of a brick hold, if they hold one.
std::optional<float> uniformAround(const BrickGrid& grid, const BrickPool& pool, const Vec3i& brick,
                                   const Vec3i& ring) {
  const Vec3i low = (brick - ring).cwiseMax(Vec3i::Zero());
  const Vec3i high = (brick + ring).cwiseMin(grid.counts() - Vec3i::Ones());
  const layout::BrickPage& own = pool.page(grid.index(brick));
  if (own.slot != NO_SLOT) return std::nullopt;
  for (int z = low.z(); z <= high.z(); ++z) {
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        const layout::BrickPage& page = pool.page(grid.index({x, y, z}));
        if (page.slot != NO_SLOT || !sameBits(page.constant, own.constant)) return std::nullopt;
      }
    }
  }
  return own.constant;
}

}  // namespace

// Tasks of the bricks inside and of those at the border, each slab by slab.
struct FilterChain::Work {
  struct Range {
    bool edge = false;
    std::size_t slab = 0;
    std::uint32_t first = 0, count = 0;
  };
  std::vector<layout::FilterTask> tasks;
  std::vector<Range> ranges;
  std::optional<gpu::Buffer> task_buffer, taps;
};

FilterChain::FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps)
    : gpu_(gpu),
      transfer_(transfer),
      source_(source),
      grid_{source.size(), source.lattice().spacing_m},
      steps_(std::move(steps)),
      result_(std::make_unique<BrickPool>(gpu, transfer, source, "filtered density")) {}

void FilterChain::run(const std::function<void(double)>& progress) {
  std::array<std::unique_ptr<BrickPool>, 2> scratch;
  const BrickPool* from = &source_;
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    if (progress) progress(static_cast<double>(i) / static_cast<double>(steps_.size()));
    const bool last = i + 1 == steps_.size();
    if (!last && !scratch[i % 2]) {
      scratch[i % 2] = std::make_unique<BrickPool>(gpu_, transfer_, source_, "filter scratch");
    }
    BrickPool& to = last ? *result_ : *scratch[i % 2];
    runStep(steps_[i], *from, to);
    from = &to;
  }
}

std::vector<layout::BrickPage> FilterChain::pagesAfter(const FilterStep& step, const BrickPool& from) const {
  std::vector<layout::BrickPage> pages(from.brickCount(), {0, 0.0F});
  const Vec3i ring = ringOf(step);
  std::optional<std::pair<float, float>> last;  // densities repeat from brick to brick
  for (std::uint32_t brick = 0; brick < pages.size(); ++brick) {
    const std::optional<float> density = uniformAround(grid_, from, grid_.brick(brick), ring);
    if (!density) continue;
    if (!last || !sameBits(last->first, *density)) last = {*density, uniformResult(step, *density)};
    pages[brick] = {NO_SLOT, last->second};
  }
  return pages;
}

void FilterChain::runStep(const FilterStep& step, const BrickPool& from, BrickPool& to) {
  to.assign(transfer_, pagesAfter(step, from));
  // In order of slots, so that what is written lies together.
  std::array<std::vector<std::vector<layout::FilterTask>>, 2> by_edge_and_slab;
  for (auto& by_slab : by_edge_and_slab) by_slab.resize(to.slabCount());
  for (std::uint32_t brick = 0; brick < to.brickCount(); ++brick) {
    const layout::BrickPage& page = to.page(brick);
    if (page.slot == NO_SLOT) continue;
    const std::size_t edge = atEdge(grid_, grid_.brick(brick), step) ? 1 : 0;
    by_edge_and_slab[edge][page.slot / BRICKS_PER_DENSITY_SLAB].push_back({brick, page.slot % BRICKS_PER_DENSITY_SLAB});
  }
  Work work;
  for (std::size_t edge = 0; edge < 2; ++edge) {
    for (std::size_t slab = 0; slab < to.slabCount(); ++slab) {
      const auto& tasks = by_edge_and_slab[edge][slab];
      if (tasks.empty()) continue;
      work.ranges.push_back(
          {edge == 1, slab, static_cast<std::uint32_t>(work.tasks.size()), static_cast<std::uint32_t>(tasks.size())});
      work.tasks.insert(work.tasks.end(), tasks.begin(), tasks.end());
    }
  }
  if (work.tasks.empty()) return;
  work.task_buffer.emplace(gpu_, "filter tasks", work.tasks.size() * sizeof(layout::FilterTask),
                           gpu::MemoryKind::kDevice);
  transfer_.upload(std::as_bytes(std::span(work.tasks)), *work.task_buffer);
  const std::vector<float> taps = kernelTaps(step);
  work.taps.emplace(gpu_, "filter taps", taps.size() * sizeof(float), gpu::MemoryKind::kDevice);
  transfer_.upload(std::as_bytes(std::span(taps)), *work.taps);
  gpu::Commands commands(gpu_, "filter", static_cast<std::uint32_t>(work.ranges.size()));
  commands.begin();
  dispatch(commands, step, from, to, work);
  commands.run();
}

void FilterChain::dispatch(gpu::Commands& commands, const FilterStep& step, const BrickPool& from, const BrickPool& to,
                           const Work& work) {
  const FilterKernel kernel = filterKernel(step);
  for (const Work::Range& range : work.ranges) {
    const layout::FilterPush push{from.domain(), range.first, range.count};
    const std::uint32_t groups = (range.count + kernel.bricks_a_group - 1) / kernel.bricks_a_group;
    commands.dispatch(kernelOf(step, from, range.edge),
                      poolBindings(from, {&*work.task_buffer, &to.slab(range.slab), &*work.taps}), gpu::pushBytes(push),
                      gpu::Groups::folded(groups, GROUPS_PER_ROW));
  }
}

const gpu::Kernel& FilterChain::kernelOf(const FilterStep& step, const BrickPool& from, bool edge) {
  const FilterKernel kernel = filterKernel(step);
  const auto slabs = static_cast<std::uint32_t>(std::min<std::size_t>(from.slabCount(), 2));
  std::vector<std::uint32_t> constants = {slabs, edge ? 1U : 0U,
                                          step.border == Border::kMirror ? BORDER_MIRROR : BORDER_NEAREST};
  constants.insert(constants.end(), kernel.constants.begin(), kernel.constants.end());
  const std::string key = fmt::format("{} {}", kernel.name, fmt::join(constants, " "));
  auto found = kernels_.find(key);
  if (found == kernels_.end()) {
    gpu::Kernel made(gpu_, {.name = kernel.name,
                            .spirv = kernelSpirv(kernel.name),
                            .bindings = FILTER_BINDINGS,
                            .push_bytes = sizeof(layout::FilterPush),
                            .specialisation = constants});
    found = kernels_.emplace(key, std::move(made)).first;
  }
  return found->second;
}

}  // namespace palpate
