// SPDX-License-Identifier: Apache-2.0
#include "engine/service/editor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_set>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/field/brick_values.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

// Bricks for which room is made at the start: 0.5 MiB of density, as much for each filtered field, and 2 MiB of
// samples.
constexpr std::size_t kSpareBricks = 256;

// plan, record, gpu, its kernels (edit, filter, smoothing, bounds, gradient, window), and the stages that the engine
// adds.
constexpr std::size_t kStagesAtMost = 11;

using BrickValues = std::array<float, kBrickVoxels>;

BrickValues valuesOf(const Volume& volume, const Vec3i& brick) {
  BrickValues values{};
  if (volume.readBrick(brick, values.data())) values.fill(values[0]);
  return values;
}

std::optional<Vec3i> reachOf(const FilterChain* chain) {
  return chain != nullptr ? std::optional(chain->reach()) : std::nullopt;
}

std::vector<std::uint32_t> touchedBricks(const EditPlan& plan) {
  std::vector<std::uint32_t> bricks;
  for (const auto& [brick, state] : plan.touched) bricks.push_back(brick);
  sortUnique(bricks);
  return bricks;
}

}  // namespace

std::vector<Editor::Link> Editor::chainsOf(const Parts& parts) {
  std::vector<Link> chains;
  if (parts.filters != nullptr) chains.push_back({*parts.filters, "filter", &EditPlan::altered});
  if (parts.smoothing != nullptr) chains.push_back({*parts.smoothing, "smoothing", &EditPlan::smoothed});
  return chains;
}

Editor::Editor(const Parts& parts, const BrushProfile& profile, bool all_samples, std::uint64_t version)
    : parts_(parts),
      chains_(chainsOf(parts)),
      profile_(profile),
      grid_(parts.pool.grid()),
      planner_({parts.pool,
                parts.store,
                reachOf(parts.filters),
                reachOf(parts.smoothing),
                parts.gradient.reach(),
                {parts.isovalue, parts.isovalue},
                all_samples},
               profile),
      all_samples_(all_samples),
      edit_(parts.gpu, parts.pool),
      tasks_(parts.gpu, "brick tasks", 1024),
      bound_tasks_(parts.gpu, "bounds tasks", 1024),
      bound_results_(parts.gpu, "edited bounds", 1024),
      touched_values_(parts.gpu, "touched bricks", 1, std::numeric_limits<std::uint64_t>::max()),  // copied, not bound
      max_dispatches_(64),
      isovalues_{parts.isovalue, parts.isovalue},
      is_changed_(parts.pool.brickCount()),
      version_(version) {
  commands_.emplace(parts.gpu, "edit", max_dispatches_);
  makeSpareRoom();
  if (!all_samples) setIsovalues(isovalues_, parts.bounds->read(parts.transfer));
}

Editor::~Editor() = default;

void Editor::setIsovalues(const layout::IsovaluePair& isovalues, std::span<const layout::BrickBounds> bounds) {
  isovalues_ = isovalues;
  planner_.setIsovalues(isovalues);
  crossed_.assign(bounds.size(), false);
  for (std::size_t brick = 0; brick < bounds.size(); ++brick) crossed_[brick] = eitherCrosses(isovalues, bounds[brick]);
}

// Optional: if there is no room now, the first edit that needs some reports it.
void Editor::makeSpareRoom() {
  try {
    parts_.pool.reserve(std::min(parts_.pool.brickCount() - parts_.pool.storedBricks(), kSpareBricks));
    for (const Link& link : chains_) link.chain.reserve(kSpareBricks);
    if (all_samples_) return;
    parts_.store.reserve(std::min(parts_.pool.brickCount() - parts_.store.brickCount(), kSpareBricks));
  } catch (const Error& error) {
    if (error.code() != Error::Code::kOutOfMemory) throw;
  }
}

void Editor::prepare(std::span<const EditKind> kinds) {
  for (const Link& link : chains_) link.chain.prepare();
  for (const EditKind kind : kinds) {
    commands_->timed(false);
    commands_->begin();
    edit_.recordIdle(*commands_, layoutKind(kind));
    if (parts_.bounds != nullptr) parts_.bounds->record(*commands_, bound_tasks_.buffer(), 0, bound_results_.buffer());
    commands_->run();
  }
}

// If the budget is short, the message covers the whole edit: densities and samples.
void Editor::makeBrickRoom(const EditPlan& plan) {
  try {
    parts_.pool.reserve(plan.new_bricks);
    parts_.store.reserve(plan.unsampled.size());
  } catch (const Error& error) {
    const GpuBudget& budget = *parts_.pool.budget();
    const std::uint64_t densities = parts_.pool.bytesToReserve(plan.new_bricks);
    const std::uint64_t samples = parts_.store.bytesToReserve(plan.unsampled.size());
    if (error.code() != Error::Code::kOutOfMemory || densities + samples <= budget.leftBytes()) throw;
    throw Error(error.code(), "GPU memory for the edit",
                fmt::format("the volume, as edited until now, takes {}, "
                            "the edit needs {} more ({} for densities, {} for samples), and the budget is {}",
                            inMiB(budget.used_bytes), inMiB(densities + samples), inMiB(densities), inMiB(samples),
                            inMiB(budget.limit_bytes)),
                fmt::format("nothing was changed; raise --gpu-memory to {} or more, or use a smaller brush",
                            wholeMiB(budget.used_bytes + densities + samples)));
  }
}

// Does everything that may fail for want of memory, kernels included. If it throws, nothing has changed.
void Editor::makeRoom(const EditPlan& plan) {
  edit_.fit(plan.phases, plan.edits, parts_.pool.stalePages());
  if (plan.phases.back().given) edit_.fitGiven(plan.phases.back().tasks.size());
  makeBrickRoom(plan);
  planChains(plan);
  tasks_.fit(plan.gradients_stale.size() + plan.unsampled.size() + WindowPass::kMaxTasks);
  bound_tasks_.fit(plan.bounds_stale.size());
  bound_results_.fit(plan.bounds_stale.size());
  if (!parts_.transfer.reaches(parts_.pool.slab(0))) {
    const auto is_stored = [](const auto& touched) { return touched.second.stored; };
    const auto stored = std::count_if(plan.touched.begin(), plan.touched.end(), is_stored);
    touched_values_.fit(static_cast<std::size_t>(stored) * kBrickVoxels);
  }
  const auto slabs = static_cast<std::uint32_t>(parts_.store.slabCount());
  // Dispatches beyond those of the edit: one more phase for pages; bounds; gradients and window, one for each slab.
  const auto window = static_cast<std::uint32_t>(WindowPass::kMaxTasks);
  std::uint32_t dispatches = edit_.dispatches(plan.phases) + DENSITY_SLABS + 2 + slabs + std::min(slabs, window);
  for (const Link& link : chains_) dispatches += link.chain.dispatches();
  if (dispatches > max_dispatches_) {
    commands_ = gpu::Commands(parts_.gpu, "edit", 2 * dispatches);  // if this throws, the old ones stay
    max_dispatches_ = 2 * dispatches;
  }
  makeKernels(plan);
}

// Each chain reads the field that the one before it computes.
void Editor::planChains(const EditPlan& plan) {
  FilterChain::SourceConstant constant = [&](std::uint32_t brick) { return planner_.constantAfter(plan, brick); };
  for (const Link& link : chains_) {
    link.chain.plan(plan.*link.changed, constant);
    constant = [&link](std::uint32_t brick) { return link.chain.constantAfter(brick); };
  }
}

// Kernels that read a pool depend on its number of slabs. So this comes after all room is made.
void Editor::makeKernels(const EditPlan& plan) {
  edit_.makeKernels(plan.phases);
  for (const Link& link : chains_) link.chain.makeKernels();
  if (parts_.bounds != nullptr) parts_.bounds->makeKernels();
  parts_.gradient.makeKernels();
  parts_.window.makeKernels();
}

void Editor::handOutSlots(EditPlan& plan) {
  writeStalePages(plan);
  for (const std::uint32_t brick : plan.made_constant) parts_.pool.empty(brick);
  for (const auto& [brick, state] : plan.touched) {
    if (state.is_new) parts_.pool.store(brick);
    if (!state.stored) parts_.pool.setConstant(brick, state.constant);
  }
  for (EditPhase& phase : plan.phases) {
    for (layout::EditTask& task : phase.tasks) {
      if (task.slot != NO_SLOT) task.slot = parts_.pool.page(task.brick).slot;
    }
  }
  for (const std::uint32_t brick : plan.unsampled)
    parts_.store.add(brick, neighbourWithSamples(grid_, parts_.store, brick));
  for (const Link& link : chains_) link.chain.commit();
}

// Writes the pages that became stale since the last edit, before anything else. The first phase does it, unless it
// reads pages of other bricks; then a phase is put before it. Call this before slots of this edit are handed out, while
// the pages here still say what the bricks hold.
void Editor::writeStalePages(EditPlan& plan) {
  const std::vector<std::uint32_t> stale = parts_.pool.takeStalePages();
  if (stale.empty()) return;
  if (plan.phases.front().stencil()) plan.phases.insert(plan.phases.begin(), EditPhase{});
  EditPhase& first = plan.phases.front();
  std::unordered_set<std::uint32_t> written;  // this phase writes the pages of its own bricks anyway
  for (const layout::EditTask& task : first.tasks) written.insert(task.brick);
  for (const std::uint32_t brick : stale) {
    const layout::BrickPage& page = parts_.pool.page(brick);
    if (page.slot == NO_SLOT && written.insert(brick).second) first.tasks.push_back({brick, NO_SLOT, 0, page.constant});
  }
}

bool Editor::reachesWindow(const EditPlan& plan, const WindowBox& box) const {
  const VoxelBox window{box.first, box.first + box.size - Vec3i::Ones()};
  const auto overlaps = [&](const VoxelBox& other) { return !intersection(window, other).empty(); };
  const auto holds = [&](std::uint32_t brick) { return overlaps(grid_.box(brick)); };
  if (std::any_of(plan.activity_unsure.begin(), plan.activity_unsure.end(), holds)) return true;
  return std::any_of(plan.gradients_stale.begin(), plan.gradients_stale.end(), holds) ||
         std::any_of(plan.altered.begin(), plan.altered.end(), holds);
}

void Editor::record(EditPlan& plan, const WindowTarget* target, Outcome& outcome) {
  gpu::Commands& commands = *commands_;
  BrickTasks gradient;
  for (const std::uint32_t brick : plan.gradients_stale) gradient.add(brick, parts_.store.place(brick));
  for (const std::uint32_t brick : plan.unsampled) gradient.add(brick, parts_.store.place(brick), true);
  std::vector<layout::BrickTask> list;
  const std::vector<TaskRange> gradient_ranges = gradient.moveTo(list);
  outcome.gradient_bricks = list.size();
  std::vector<TaskRange> window_ranges;
  outcome.window_gathered = target != nullptr && reachesWindow(plan, target->box);
  if (outcome.window_gathered) {
    const auto among = [](const std::vector<std::uint32_t>& bricks, std::size_t brick) {
      return std::binary_search(bricks.begin(), bricks.end(), static_cast<std::uint32_t>(brick));
    };
    const auto unsure = [&](std::size_t brick) { return among(plan.activity_unsure, brick); };
    const auto stale = [&](std::size_t brick) {
      return target->previous == nullptr || unsure(brick) || among(plan.gradients_stale, brick) ||
             among(plan.altered, brick);
    };
    window_ranges = parts_.window.tasksOf(target->box, stale, unsure).moveTo(list);
    if (target->previous != nullptr) {
      const auto samples = static_cast<std::size_t>(target->box.size.prod());
      std::memcpy(target->buffer->mapped(), target->previous->mapped(), samples * sizeof(Sample));
    }
  }
  std::vector<layout::BrickTask> bounds_list;
  for (const std::uint32_t brick : plan.bounds_stale) bounds_list.push_back({brick, NO_SLOT});

  commands.timed(times_kernels_);
  commands.begin();
  edit_.write(plan.phases, plan.edits);
  tasks_.write(list);
  bound_tasks_.write(bounds_list);
  edit_.record(commands, plan.phases);
  commands.mark("edit");
  for (const Link& link : chains_) {
    link.chain.record(commands);
    commands.mark(link.name);
  }
  ActiveTest test{nullptr, isovalues_};
  if (parts_.bounds != nullptr) {
    test.bounds = &parts_.bounds->bounds();
    parts_.bounds->record(commands, bound_tasks_.buffer(), static_cast<std::uint32_t>(bounds_list.size()),
                          bound_results_.buffer());
    commands.barrier();
    commands.mark("bounds");
  }
  parts_.gradient.record(commands, tasks_.buffer(), gradient_ranges, test);
  commands.barrier();
  commands.mark("gradient");
  if (!outcome.window_gathered) return;
  parts_.window.record(commands, target->box, tasks_.buffer(), window_ranges, test, *target->buffer);
  commands.mark("window");
}

// If the host cannot map the slabs, copies the touched bricks to memory that it can map.
void Editor::downloadTouched() {
  if (parts_.transfer.reaches(parts_.pool.slab(0))) return;
  commands_->barrier();
  for (std::size_t i = 0; i < stored_.size(); ++i) {
    const BrickPool::Place at = BrickPool::place(parts_.pool.page(stored_[i]).slot);
    constexpr std::size_t kBytes = kBrickVoxels * sizeof(float);
    commands_->copy(parts_.pool.slab(at.slab), at.offset_bytes, touched_values_.buffer(), i * kBytes, kBytes);
  }
}

void Editor::refuseIfBroken() const {
  if (!broken_) return;
  throw Error(Error::Code::kDevice, "edit",
              "the device failed in the middle of an edit, so the volume there is not known any more",
              "what was saved before is whole; start again from that and from the journal");
}

Editor::Outcome Editor::apply(std::span<const EditCommand> commands, const WindowTarget* target,
                              const BeforeChange& before) {
  refuseIfBroken();
  settle();
  const Stopwatch watch;
  EditPlan plan = planner_.plan(commands);
  const double planned_s = watch.seconds();
  if (before) before(touchedBricks(plan));
  return run(plan, target, {}, planned_s);
}

Editor::Outcome Editor::replace(std::span<const BrickContent> bricks, const WindowTarget* target) {
  refuseIfBroken();
  settle();
  const Stopwatch watch;
  EditPlan plan = planner_.plan(bricks);
  return run(plan, target, bricks, watch.seconds());
}

Editor::Outcome Editor::run(EditPlan& plan, const WindowTarget* target, std::span<const BrickContent> given,
                            double planned_s) {
  Outcome outcome;
  outcome.changed_bricks = plan.touched.size();
  if (plan.touched.empty()) {  // the commands would change nothing within reach
    outcome.version = ++version_;
    return outcome;
  }
  const Stopwatch making_room;
  try {
    makeRoom(plan);
  } catch (...) {
    for (const Link& link : chains_) link.chain.abandon();
    throw;
  }
  outcome.stages.reserve(kStagesAtMost);
  outcome.stages.push_back({"plan", planned_s + making_room.seconds()});

  const Stopwatch recording;
  broken_ = true;  // from here on pages and slots describe the state after the GPU's work
  handOutSlots(plan);
  stored_.clear();
  for (const auto& [brick, state] : plan.touched) {
    if (state.stored) stored_.push_back(brick);
    noteChanged(brick);
  }
  record(plan, target, outcome);
  handOver(plan, given);
  downloadTouched();
  outcome.stages.push_back({"record", recording.seconds()});

  const Stopwatch computing;
  commands_->run();
  outcome.stages.push_back({"gpu", computing.seconds()});
  for (StageTime& stage : commands_->marks()) outcome.stages.push_back(std::move(stage));
  for (const std::uint32_t brick : plan.altered) {
    const auto touched = plan.touched.find(brick);  // behind filters others are altered too, and further
    const bool is_known = parts_.filters == nullptr && touched != plan.touched.end();
    outcome.altered.push_back({brick, is_known ? touched->second.changed : grid_.box(brick)});
  }
  bounds_stale_ = std::move(plan.bounds_stale);
  activity_unsure_ = std::move(plan.activity_unsure);
  settled_ = false;
  outcome.version = ++version_;
  broken_ = false;
  return outcome;
}

// Uploads the given densities in the order of the tasks, which were sorted by slab.
void Editor::handOver(const EditPlan& plan, std::span<const BrickContent> given) {
  if (given.empty()) return;
  std::unordered_map<std::uint32_t, const BrickContent*> by_brick;
  for (const BrickContent& content : given) by_brick[content.brick] = &content;
  std::vector<float> values;
  for (const layout::EditTask& task : plan.phases.back().tasks) {
    const std::vector<float>& from = by_brick.at(task.brick)->values;
    values.insert(values.end(), from.begin(), from.end());
  }
  edit_.given().write(values);
}

BrickContent Editor::content(std::uint32_t brick) const {
  refuseIfBroken();
  return read(brick);
}

BrickContent Editor::read(std::uint32_t brick) const {
  std::array<float, kBrickVoxels> values{};
  const bool is_constant = parts_.pool.readBrick(parts_.transfer, brick, values.data());
  return {brick, {values.begin(), is_constant ? values.begin() + 1 : values.end()}};
}

std::vector<std::uint32_t> Editor::bricksToChange(std::span<const EditCommand> commands) const {
  return touchedBricks(planner_.plan(commands));
}

bool Editor::isActive(std::uint32_t brick) const {
  bool active = false;
  grid_.forEachAtCorner(grid_.brick(brick), -1, [&](std::uint32_t other) { active = active || crossed_[other]; });
  return active;
}

void Editor::settle() {
  if (settled_) return;
  settled_ = true;
  for (std::size_t i = 0; i < stored_.size(); ++i) {
    const BrickPool::Place at = BrickPool::place(parts_.pool.page(stored_[i]).slot);
    const gpu::Buffer& slab = parts_.pool.slab(at.slab);
    const float* values =
        parts_.transfer.reaches(slab)
            ? reinterpret_cast<const float*>(static_cast<const std::byte*>(slab.mapped()) + at.offset_bytes)
            : touched_values_.read((i + 1) * kBrickVoxels).data() + i * kBrickVoxels;
    if (holdOneValue(std::span<const float, kBrickVoxels>(values, kBrickVoxels)))
      parts_.pool.makeConstant(stored_[i], values[0]);
  }
  for (const Link& link : chains_) link.chain.settle();
  if (all_samples_) return;
  const auto bounds = bound_results_.read(bounds_stale_.size());
  for (std::size_t i = 0; i < bounds_stale_.size(); ++i)
    crossed_[bounds_stale_[i]] = eitherCrosses(isovalues_, bounds[i]);
  for (const std::uint32_t brick : activity_unsure_) {
    if (parts_.store.has(brick) && !isActive(brick)) parts_.store.remove(brick);
  }
}

void Editor::noteChanged(std::uint32_t brick) {
  if (is_changed_[brick]) return;
  is_changed_[brick] = true;
  changed_.push_back(brick);
}

std::size_t Editor::readBack(Volume& volume) {
  refuseIfBroken();
  settle();
  BrickValues values{};
  std::size_t count = 0;
  for (const std::uint32_t brick : changed_) {
    const Vec3i at = grid_.brick(brick);
    const BrickValues before = valuesOf(volume, at);
    const bool is_constant = parts_.pool.readBrick(parts_.transfer, brick, values.data());
    putBrick(volume, at, std::span(values).first(is_constant ? 1 : kBrickVoxels));
    const BrickValues after = valuesOf(volume, at);
    if (!sameBits(before, after)) ++count;
    is_changed_[brick] = false;
  }
  changed_.clear();
  return count;
}

std::vector<BrickContent> Editor::takeChanged(std::size_t most) {
  refuseIfBroken();
  settle();
  broken_ = true;  // if this throws, bricks taken so far would be missing in every later file
  std::vector<BrickContent> taken;
  while (!changed_.empty() && taken.size() < most) {
    taken.push_back(read(changed_.back()));
    is_changed_[changed_.back()] = false;
    changed_.pop_back();
  }
  broken_ = false;
  return taken;
}

}  // namespace palpate
