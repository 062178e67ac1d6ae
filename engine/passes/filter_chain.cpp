// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/filter_chain.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include <fmt/format.h>

#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/filter_kernels.hpp"
#include "engine/passes/pool_kernel.hpp"
#include "engine/passes/uniform_bricks.hpp"
#include "shaders/kernels.hpp"

namespace palpate {
namespace {

// Of a whole field, so that it can be stopped, and no device gives up on a slow filter: the slowest takes some 2 ms a
// brick on lavapipe, a fast one 3 us, against 0.1 ms for a submission.
constexpr std::uint32_t kBricksASubmission = 1024;

gpu::Buffer tapBuffer(gpu::Gpu& gpu, gpu::Transfer& transfer, const FilterStep& step) {
  const std::vector<float> taps = kernelTaps(step);
  gpu::Buffer buffer(gpu, "filter taps", taps.size() * sizeof(float), gpu::MemoryKind::kDevice);
  transfer.upload(std::as_bytes(std::span(taps)), buffer);
  return buffer;
}

}  // namespace

FilterChain::FilterChain(gpu::Gpu& gpu, gpu::Transfer& transfer, const BrickPool& source, std::vector<FilterStep> steps)
    : gpu_(gpu),
      transfer_(transfer),
      source_(source),
      grid_{source.size(), source.lattice().spacing_m},
      steps_(std::move(steps)),
      routes_(routesOf(steps_)),
      reach_(totalReach(steps_)),
      result_(std::make_unique<BrickPool>(gpu, transfer, source, "filtered density")),
      page_kernel_(gpu, {.name = "page_write",
                         .spirv = kernelSpirv("page_write"),
                         .bindings = PAGE_WRITE_BINDINGS,
                         .push_bytes = sizeof(layout::PageWritePush),
                         .specialisation = {}}),
      task_list_(gpu, "filter tasks", 1),
      page_list_(gpu, "pages to write", 1) {
  for (const FilterStep& step : steps_) taps_.push_back(tapBuffer(gpu, transfer, step));
}

std::size_t FilterChain::scratchBytes() const noexcept {
  std::size_t bytes = 0;
  for (const auto& pool : scratch_) bytes += pool ? pool->bytes() : 0;
  return bytes;
}

// The whole field.

void FilterChain::run(const std::function<void(double)>& progress) {
  std::array<std::unique_ptr<BrickPool>, FilterRoute::kResult> scratch;
  const auto poolOf = [&](std::size_t i) -> BrickPool& {
    if (i == FilterRoute::kResult) return *result_;
    if (!scratch[i]) scratch[i] = std::make_unique<BrickPool>(gpu_, transfer_, source_, "filter scratch");
    return *scratch[i];
  };
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const int read = routes_[i].from;
    const BrickPool& from =
        read == FilterRoute::kSource ? source_ : poolOf(routes_[static_cast<std::size_t>(read)].pool);
    if (steps_[i].kind == StepKind::kDistanceSeed) findBand(steps_[i], from);
    runStep(i, from, poolOf(routes_[i].pool), [&](double part) {
      if (progress) progress((static_cast<double>(i) + part) / static_cast<double>(steps_.size()));
    });
  }
}

void FilterChain::findBand(const FilterStep& seed, const BrickPool& densities) {
  BrickBoundsPass bounds(gpu_, densities);
  bounds.run();
  band_ = distanceBricks(seed, bounds.read(transfer_), densities.brickCounts());
}

std::vector<layout::BrickPage> FilterChain::pagesAfter(const FilterStep& step, const BrickPool& from) const {
  if (step.kind == StepKind::kDistanceFinish) return band_;  // the slots that the last spread wrote
  if (step.kind == StepKind::kDistanceSeed || step.kind == StepKind::kDistanceSpread) {
    std::vector<layout::BrickPage> pages = band_;
    for (layout::BrickPage& page : pages) page.constant = uniformResult(step, page.constant);
    return pages;
  }
  std::vector<layout::BrickPage> pages(from.brickCount(), {0, 0.0F});
  const Vec3i ring = ringOf(step);
  const auto constantOf = [&](std::uint32_t brick) {
    const layout::BrickPage& page = from.page(brick);
    return page.slot == NO_SLOT ? std::optional(page.constant) : std::nullopt;
  };
  std::optional<std::pair<std::uint32_t, float>> last;  // densities repeat from brick to brick
  for (std::uint32_t brick = 0; brick < pages.size(); ++brick) {
    const std::optional<float> density = uniformAround(grid_, brick, ring, constantOf);
    if (!density) continue;
    const auto bits = std::bit_cast<std::uint32_t>(*density);
    if (!last || last->first != bits) last = {bits, uniformResult(step, *density)};
    pages[brick] = {NO_SLOT, last->second};
  }
  return pages;
}

void FilterChain::runStep(std::size_t step, const BrickPool& from, BrickPool& to,
                          const std::function<void(double)>& progress) {
  progress(0);
  to.assign(transfer_, pagesAfter(steps_[step], from));
  FilterTasks by_range(grid_, steps_[step]);
  for (std::uint32_t brick = 0; brick < to.brickCount(); ++brick) {
    if (to.page(brick).slot != NO_SLOT) by_range.add(brick, to.page(brick).slot);
  }
  std::vector<layout::FilterTask> list;
  const std::vector<FilterRange> ranges = by_range.moveTo(list);
  if (list.empty()) return;
  const gpu::Buffer tasks(gpu_, "filter tasks", list.size() * sizeof(layout::FilterTask), gpu::MemoryKind::kDevice);
  transfer_.upload(std::as_bytes(std::span(list)), tasks);
  gpu::Commands commands(gpu_, "filter", 1);
  std::uint32_t done = 0;
  for (const FilterRange& range : ranges) {
    for (std::uint32_t first = 0; first < range.count; first += kBricksASubmission) {
      FilterRange part = range;
      part.first += first;
      part.count = std::min(range.count - first, kBricksASubmission);
      commands.begin();
      dispatch(commands, step, from, to, tasks, {&part, 1});
      commands.run();
      done += part.count;
      progress(static_cast<double>(done) / static_cast<double>(list.size()));
    }
  }
}

void FilterChain::dispatch(gpu::Commands& commands, std::size_t step, const BrickPool& from, const BrickPool& to,
                           const gpu::Buffer& tasks, std::span<const FilterRange> ranges) {
  const FilterKernel kernel = filterKernel(steps_[step]);
  for (const FilterRange& range : ranges) {
    const layout::FilterPush push{from.domain(), range.first, range.count};
    const std::uint32_t groups = std::max(1U, (range.count + kernel.bricks_a_group - 1) / kernel.bricks_a_group);
    commands.dispatch(kernelOf(steps_[step], from, range.edge),
                      poolBindings(from, {&tasks, &to.slab(range.slab), &taps_[step]}), gpu::pushBytes(push),
                      gpu::Groups::folded(groups, GROUPS_PER_ROW));
  }
}

const gpu::Kernel& FilterChain::kernelOf(const FilterStep& step, const BrickPool& from, bool edge) {
  const FilterKernel kernel = filterKernel(step);
  const auto slabs = static_cast<std::uint32_t>(from.slabCount());
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

// A region.

BrickPool& FilterChain::scratch(std::size_t i) {
  if (!scratch_[i]) scratch_[i] = std::make_unique<BrickPool>(gpu_, transfer_, source_, "filter scratch");
  return *scratch_[i];
}

const BrickPool& FilterChain::readBy(std::size_t step) const {
  const int from = routes_[step].from;
  return from == FilterRoute::kSource ? source_ : writtenBy(static_cast<std::size_t>(from));
}

const BrickPool& FilterChain::writtenBy(std::size_t step) const {
  const std::size_t pool = routes_[step].pool;
  return pool == FilterRoute::kResult ? *result_ : *scratch_[pool];
}

bool FilterChain::inPlaceFollows(std::size_t step) const noexcept {
  return step + 1 < routes_.size() && routes_[step + 1].in_place;
}

// Backwards for what each step must write, forwards for which of that is constant.
std::vector<FilterChain::Level> FilterChain::levelsOf(std::span<const std::uint32_t> bricks,
                                                      const SourceConstant& source_constant) const {
  std::vector<std::vector<std::uint32_t>> wanted(steps_.size());
  wanted.back().assign(bricks.begin(), bricks.end());
  std::vector<Level> levels(steps_.size());
  for (std::size_t i = steps_.size(); i-- > 0;) {
    sortUnique(wanted[i]);
    for (const std::uint32_t brick : wanted[i]) levels[i].bricks.push_back({brick, std::nullopt});
    if (routes_[i].in_place) wanted[i - 1] = wanted[i];
    if (routes_[i].from == FilterRoute::kSource) continue;
    std::vector<std::uint32_t>& read = wanted[static_cast<std::size_t>(routes_[i].from)];
    for (const std::uint32_t brick : wanted[i]) {
      forEachAround(grid_, grid_.brick(brick), ringOf(steps_[i]), [&](std::uint32_t other) {
        read.push_back(other);
        return true;
      });
    }
  }
  for (std::size_t i = 0; i < steps_.size(); ++i) findConstants(i, levels, source_constant);
  return levels;
}

void FilterChain::findConstants(std::size_t step, std::vector<Level>& levels,
                                const SourceConstant& source_constant) const {
  const auto before = [&](std::uint32_t brick) -> std::optional<float> {
    if (routes_[step].from == FilterRoute::kSource) return source_constant(brick);
    return find(levels[static_cast<std::size_t>(routes_[step].from)], brick)->constant;
  };
  Level& level = levels[step];
  for (std::size_t n = 0; n < level.bricks.size(); ++n) {
    LevelBrick& entry = level.bricks[n];
    // What is changed in place is constant where that was; there the densities around were too.
    const std::optional<float> density = !routes_[step].in_place
                                             ? uniformAround(grid_, entry.brick, ringOf(steps_[step]), before)
                                         : levels[step - 1].bricks[n].constant ? before(entry.brick)
                                                                               : std::nullopt;
    if (density) entry.constant = uniformResult(steps_[step], *density);
    level.stored += density ? 0 : 1;
  }
}

const FilterChain::LevelBrick* FilterChain::find(const Level& level, std::uint32_t brick) {
  const auto found = std::lower_bound(level.bricks.begin(), level.bricks.end(), brick,
                                      [](const LevelBrick& a, std::uint32_t b) { return a.brick < b; });
  return found != level.bricks.end() && found->brick == brick ? &*found : nullptr;
}

std::optional<float> FilterChain::constantAfter(std::uint32_t brick) const {
  const LevelBrick* planned = levels_.empty() ? nullptr : find(levels_.back(), brick);
  if (planned != nullptr) return planned->constant;
  const layout::BrickPage& page = result_->page(brick);
  return page.slot == NO_SLOT ? std::optional(page.constant) : std::nullopt;
}

std::size_t FilterChain::newBricks(const Level& last) const {
  return static_cast<std::size_t>(std::count_if(last.bricks.begin(), last.bricks.end(), [&](const LevelBrick& entry) {
    return !entry.constant && result_->page(entry.brick).slot == NO_SLOT;
  }));
}

void FilterChain::plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant) {
  std::vector<Level> levels = levelsOf(bricks, source_constant);
  std::array<std::size_t, FilterRoute::kResult> most{};
  std::size_t tasks = 0;
  std::size_t pages = result_->stalePages();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    tasks += levels[i].stored;
    pages += levels[i].bricks.size();
    const std::size_t pool = routes_[i].pool;
    if (pool == FilterRoute::kResult) continue;
    most[pool] = std::max(most[pool], levels[i].stored);
    scratch(pool).reserve(most[pool]);
  }
  result_->reserve(newBricks(levels.back()));
  task_list_.fit(tasks);
  page_list_.fit(pages);
  levels_ = std::move(levels);
}

void FilterChain::abandon() noexcept {
  levels_.clear();
  for (auto& pool : scratch_) pool.reset();
}

void FilterChain::makeKernels() {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    for (const bool edge : {false, true}) static_cast<void>(kernelOf(steps_[i], readBy(i), edge));
  }
}

void FilterChain::commit() {
  tasks_.clear();
  pages_.clear();
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    levels_[i].first_page = static_cast<std::uint32_t>(pages_.size());
    if (!routes_[i].in_place) {  // else slots and pages were handed out with the step before
      const Level& level = inPlaceFollows(i) ? levels_[i + 1] : levels_[i];
      routes_[i].pool == FilterRoute::kResult ? handOutResult(level) : handOutScratch(level);
    }
    levels_[i].page_count = static_cast<std::uint32_t>(pages_.size()) - levels_[i].first_page;
    listTasks(i);
  }
}

// Slots from the first on: what lay there is of no use any more.
void FilterChain::handOutScratch(const Level& level) {
  std::uint32_t slot = 0;
  for (const LevelBrick& entry : level.bricks) {
    if (entry.constant) {
      pages_.push_back({entry.brick, NO_SLOT, *entry.constant});
    } else {
      pages_.push_back({entry.brick, slot++, 0.0F});
    }
  }
}

// Pages are written before the step runs, and nothing before it reads the result, so freed slots may be taken at once.
void FilterChain::handOutResult(const Level& level) {
  for (const std::uint32_t brick : result_->takeStalePages()) {
    if (find(level, brick) != nullptr) continue;
    pages_.push_back({brick, NO_SLOT, result_->page(brick).constant});
  }
  for (const LevelBrick& entry : level.bricks) {
    if (!entry.constant) continue;
    if (result_->page(entry.brick).slot != NO_SLOT) result_->empty(entry.brick);
    result_->setConstant(entry.brick, *entry.constant);
    pages_.push_back({entry.brick, NO_SLOT, *entry.constant});
  }
  for (const LevelBrick& entry : level.bricks) {
    if (entry.constant || result_->page(entry.brick).slot != NO_SLOT) continue;
    pages_.push_back({entry.brick, result_->store(entry.brick), 0.0F});
  }
}

void FilterChain::listTasks(std::size_t step) {
  FilterTasks by_range(grid_, steps_[step]);
  std::uint32_t scratch_slot = 0;
  for (const LevelBrick& entry : levels_[step].bricks) {
    if (entry.constant) continue;
    const bool result = routes_[step].pool == FilterRoute::kResult;
    by_range.add(entry.brick, result ? result_->page(entry.brick).slot : scratch_slot++);
  }
  levels_[step].ranges = by_range.moveTo(tasks_);
}

std::uint32_t FilterChain::dispatches() const noexcept {
  return static_cast<std::uint32_t>(steps_.size()) * (1 + 2 * DENSITY_SLABS);  // pages; inside and edge, by slab
}

void FilterChain::record(gpu::Commands& commands) {
  task_list_.write(tasks_);
  page_list_.write(pages_);
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    const Level& level = levels_[i];
    if (level.page_count > 0) {
      const layout::PageWritePush push{level.first_page, level.page_count};
      const std::uint32_t groups = (level.page_count + PAGE_WRITE_GROUP - 1) / PAGE_WRITE_GROUP;
      commands.dispatch(page_kernel_, std::array{&page_list_.buffer(), &writtenBy(i).pages()}, gpu::pushBytes(push),
                        gpu::Groups::folded(groups, GROUPS_PER_ROW));
    }
    dispatch(commands, i, readBy(i), writtenBy(i), task_list_.buffer(), level.ranges);
    commands.barrier();
  }
}

void FilterChain::settle() {
  if (levels_.empty()) return;
  std::vector<std::uint32_t> bricks;
  for (const LevelBrick& entry : levels_.back().bricks) {
    if (!entry.constant) bricks.push_back(entry.brick);
  }
  const std::vector<Level> levels = levelsOf(bricks, [&](std::uint32_t brick) {
    const layout::BrickPage& page = source_.page(brick);
    return page.slot == NO_SLOT ? std::optional(page.constant) : std::nullopt;
  });
  for (const LevelBrick& entry : levels.back().bricks) {
    if (entry.constant) result_->makeConstant(entry.brick, *entry.constant);
  }
  levels_.clear();
}

void FilterChain::reserve(std::size_t bricks) {
  result_->reserve(std::min(result_->brickCount() - result_->storedBricks(), bricks));
}

void FilterChain::prepare() {
  for (const FilterRoute& route : routes_) {
    if (route.pool != FilterRoute::kResult) static_cast<void>(scratch(route.pool));
  }
  gpu::Commands commands(gpu_, "filter kernels", dispatches());
  commands.begin();
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    for (const bool edge : {false, true}) {
      const FilterRange none{edge, 0, 0, 0};
      dispatch(commands, i, readBy(i), writtenBy(i), task_list_.buffer(), std::span(&none, 1));
      commands.barrier();
    }
  }
  const layout::PageWritePush push{0, 0};
  commands.dispatch(page_kernel_, std::array{&page_list_.buffer(), &result_->pages()}, gpu::pushBytes(push), {});
  commands.run();
}

}  // namespace palpate
