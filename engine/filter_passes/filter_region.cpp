// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_region.hpp"

#include <algorithm>
#include <utility>

#include "engine/filter_passes/constant_bricks.hpp"
#include "shaders/kernels.hpp"

namespace palpate {

FilterRegion::FilterRegion(gpu::Gpu& gpu, gpu::Transfer& transfer, FilterDispatch& dispatch,
                           std::span<const FilterRoute> routes, const BrickPool& source, BrickPool& result)
    : gpu_(gpu),
      transfer_(transfer),
      dispatch_(dispatch),
      steps_(dispatch.steps()),
      routes_(routes),
      source_(source),
      result_(result),
      grid_(source.grid()),
      page_kernel_(gpu, {.name = "page_write",
                         .spirv = kernelSpirv("page_write"),
                         .bindings = PAGE_WRITE_BINDINGS,
                         .push_bytes = sizeof(layout::PageWritePush),
                         .specialisation = {}}),
      task_list_(gpu, "filter tasks", 1),
      page_list_(gpu, "pages to write", 1) {}

std::size_t FilterRegion::scratchBytes() const noexcept {
  std::size_t bytes = 0;
  for (const auto& pool : scratch_) bytes += pool ? pool->bytes() : 0;
  return bytes;
}

BrickPool& FilterRegion::scratch(std::size_t i) {
  if (!scratch_[i]) scratch_[i] = std::make_unique<BrickPool>(gpu_, transfer_, source_, "filter scratch");
  return *scratch_[i];
}

const BrickPool& FilterRegion::readBy(std::size_t step) const {
  const int from = routes_[step].from;
  return from == FilterRoute::kSource ? source_ : writtenBy(static_cast<std::size_t>(from));
}

const BrickPool& FilterRegion::writtenBy(std::size_t step) const {
  const std::size_t pool = routes_[step].pool;
  return pool == FilterRoute::kResult ? result_ : *scratch_[pool];
}

bool FilterRegion::inPlaceFollows(std::size_t step) const noexcept {
  return step + 1 < routes_.size() && routes_[step + 1].in_place;
}

// Goes backwards through the steps to find what each must write. Then it goes forwards to find which of these bricks
// are constant.
std::vector<FilterRegion::StepOutput> FilterRegion::outputsOf(std::span<const std::uint32_t> bricks,
                                                              const SourceConstant& source_constant) const {
  std::vector<std::vector<std::uint32_t>> wanted(steps_.size());
  wanted.back().assign(bricks.begin(), bricks.end());
  std::vector<StepOutput> outputs(steps_.size());
  for (std::size_t i = steps_.size(); i-- > 0;) {
    sortUnique(wanted[i]);
    for (const std::uint32_t brick : wanted[i]) outputs[i].bricks.push_back({brick, std::nullopt});
    if (routes_[i].in_place) wanted[i - 1] = wanted[i];
    if (routes_[i].from == FilterRoute::kSource) continue;
    std::vector<std::uint32_t>& read = wanted[static_cast<std::size_t>(routes_[i].from)];
    for (const std::uint32_t brick : wanted[i]) {
      grid_.forEachWithin(grid_.brick(brick), ringOf(steps_[i]), [&](std::uint32_t other) { read.push_back(other); });
    }
  }
  for (std::size_t i = 0; i < steps_.size(); ++i) findConstants(i, outputs, source_constant);
  return outputs;
}

void FilterRegion::findConstants(std::size_t step, std::vector<StepOutput>& outputs,
                                 const SourceConstant& source_constant) const {
  const auto before = [&](std::uint32_t brick) -> std::optional<float> {
    if (routes_[step].from == FilterRoute::kSource) return source_constant(brick);
    return find(outputs[static_cast<std::size_t>(routes_[step].from)], brick)->constant;
  };
  StepOutput& output = outputs[step];
  for (std::size_t n = 0; n < output.bricks.size(); ++n) {
    OutputBrick& entry = output.bricks[n];
    // A step in place yields a constant brick where the brick that it rewrites is constant. That brick is constant only
    // where the densities around it are.
    const std::optional<float> density = !routes_[step].in_place
                                             ? uniformAround(grid_, entry.brick, ringOf(steps_[step]), before)
                                         : outputs[step - 1].bricks[n].constant ? before(entry.brick)
                                                                                : std::nullopt;
    if (density) entry.constant = uniformResult(steps_[step], *density);
    output.stored += density ? 0 : 1;
  }
}

const FilterRegion::OutputBrick* FilterRegion::find(const StepOutput& output, std::uint32_t brick) {
  const auto found = std::lower_bound(output.bricks.begin(), output.bricks.end(), brick,
                                      [](const OutputBrick& a, std::uint32_t b) { return a.brick < b; });
  return found != output.bricks.end() && found->brick == brick ? &*found : nullptr;
}

std::optional<float> FilterRegion::constantAfter(std::uint32_t brick) const {
  const OutputBrick* planned = outputs_.empty() ? nullptr : find(outputs_.back(), brick);
  if (planned != nullptr) return planned->constant;
  return result_.constantOf(brick);
}

std::size_t FilterRegion::newBricks(const StepOutput& last) const {
  return static_cast<std::size_t>(std::count_if(last.bricks.begin(), last.bricks.end(), [&](const OutputBrick& entry) {
    return !entry.constant && !result_.isStored(entry.brick);
  }));
}

void FilterRegion::plan(std::span<const std::uint32_t> bricks, const SourceConstant& source_constant) {
  std::vector<StepOutput> outputs = outputsOf(bricks, source_constant);
  std::array<std::size_t, FilterRoute::kResult> most{};
  std::size_t tasks = 0;
  std::size_t pages = result_.stalePages();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    tasks += outputs[i].stored;
    pages += outputs[i].bricks.size();
    const std::size_t pool = routes_[i].pool;
    if (pool == FilterRoute::kResult) continue;
    most[pool] = std::max(most[pool], outputs[i].stored);
    scratch(pool).reserve(most[pool]);
  }
  result_.reserve(newBricks(outputs.back()));
  task_list_.fit(tasks);
  page_list_.fit(pages);
  outputs_ = std::move(outputs);
}

void FilterRegion::abandon() noexcept {
  outputs_.clear();
  for (auto& pool : scratch_) pool.reset();
}

void FilterRegion::makeKernels() {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    for (const bool edge : {false, true}) {
      if (edge && !dispatch_.hasEdge(i)) continue;
      static_cast<void>(dispatch_.kernel(i, readBy(i), edge));
    }
  }
}

void FilterRegion::commit() {
  tasks_.clear();
  pages_.clear();
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    outputs_[i].first_page = static_cast<std::uint32_t>(pages_.size());
    if (!routes_[i].in_place) {  // otherwise it uses the slots and pages of the step before
      const StepOutput& output = inPlaceFollows(i) ? outputs_[i + 1] : outputs_[i];
      routes_[i].pool == FilterRoute::kResult ? handOutResult(output) : handOutScratch(output);
    }
    outputs_[i].page_count = static_cast<std::uint32_t>(pages_.size()) - outputs_[i].first_page;
    listTasks(i);
  }
}

// Hands out slots from the first one on. Their old content is no longer needed.
void FilterRegion::handOutScratch(const StepOutput& output) {
  std::uint32_t slot = 0;
  for (const OutputBrick& entry : output.bricks) {
    if (entry.constant) {
      pages_.push_back({entry.brick, NO_SLOT, *entry.constant});
    } else {
      pages_.push_back({entry.brick, slot++, 0.0F});
    }
  }
}

// Pages are written before the step runs, and no earlier step reads the result. So slots that are freed here may be
// used again at once.
void FilterRegion::handOutResult(const StepOutput& output) {
  for (const std::uint32_t brick : result_.takeStalePages()) {
    if (find(output, brick) != nullptr) continue;
    pages_.push_back({brick, NO_SLOT, result_.page(brick).constant});
  }
  for (const OutputBrick& entry : output.bricks) {
    if (!entry.constant) continue;
    if (result_.isStored(entry.brick)) result_.empty(entry.brick);
    result_.setConstant(entry.brick, *entry.constant);
    pages_.push_back({entry.brick, NO_SLOT, *entry.constant});
  }
  for (const OutputBrick& entry : output.bricks) {
    if (entry.constant || result_.isStored(entry.brick)) continue;
    pages_.push_back({entry.brick, result_.store(entry.brick), 0.0F});
  }
}

void FilterRegion::listTasks(std::size_t step) {
  FilterTasks by_range(grid_, steps_[step], dispatch_.hasEdge(step));
  std::uint32_t scratch_slot = 0;
  for (const OutputBrick& entry : outputs_[step].bricks) {
    if (entry.constant) continue;
    const bool result = routes_[step].pool == FilterRoute::kResult;
    by_range.add(entry.brick, result ? result_.page(entry.brick).slot : scratch_slot++);
  }
  outputs_[step].ranges = by_range.moveTo(tasks_);
}

std::uint32_t FilterRegion::dispatchesOf(std::size_t steps) noexcept {
  // For each step: its pages, then for each slab its inner and its border bricks.
  return static_cast<std::uint32_t>(steps) * (1 + 2 * DENSITY_SLABS);
}

void FilterRegion::record(gpu::Commands& commands) {
  task_list_.write(tasks_);
  page_list_.write(pages_);
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const StepOutput& output = outputs_[i];
    if (output.page_count > 0) {
      const layout::PageWritePush push{output.first_page, output.page_count};
      const std::uint32_t groups = (output.page_count + PAGE_WRITE_GROUP - 1) / PAGE_WRITE_GROUP;
      commands.dispatch(page_kernel_, std::array{&page_list_.buffer(), &writtenBy(i).pages()}, gpu::pushBytes(push),
                        gpu::Groups::folded(groups, GROUPS_PER_ROW));
    }
    dispatch_.record(commands, i, readBy(i), writtenBy(i), task_list_.buffer(), output.ranges);
    commands.barrier();
  }
}

void FilterRegion::settle() {
  if (outputs_.empty()) return;
  std::vector<std::uint32_t> bricks;
  for (const OutputBrick& entry : outputs_.back().bricks) {
    if (!entry.constant) bricks.push_back(entry.brick);
  }
  const std::vector<StepOutput> outputs =
      outputsOf(bricks, [&](std::uint32_t brick) { return source_.constantOf(brick); });
  for (const OutputBrick& entry : outputs.back().bricks) {
    if (entry.constant) result_.makeConstant(entry.brick, *entry.constant);
  }
  outputs_.clear();
}

void FilterRegion::prepare() {
  for (const FilterRoute& route : routes_) {
    if (route.pool != FilterRoute::kResult) static_cast<void>(scratch(route.pool));
  }
  gpu::Commands commands(gpu_, "filter kernels", dispatchesOf(steps_.size()));
  commands.begin();
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    for (const bool edge : {false, true}) {
      if (edge && !dispatch_.hasEdge(i)) continue;
      const FilterRange none{edge, 0, 0, 0};
      dispatch_.record(commands, i, readBy(i), writtenBy(i), task_list_.buffer(), std::span(&none, 1));
      commands.barrier();
    }
  }
  const layout::PageWritePush push{0, 0};
  commands.dispatch(page_kernel_, std::array{&page_list_.buffer(), &result_.pages()}, gpu::pushBytes(push), {});
  commands.run();
}

}  // namespace palpate
