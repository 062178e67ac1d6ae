// SPDX-License-Identifier: Apache-2.0
#include "engine/service/editor.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_set>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/volume/brick_values.hpp"
#include "servo/window/sample_window.hpp"

namespace palpate {
namespace {

// Room made at the start: 0.5 MiB of density and of each field that chains make of it, 2 MiB of samples.
constexpr std::size_t kSpareBricks = 256;

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

bool crosses(const layout::BrickBounds& bounds, float isovalue) {
  return bounds.lowest <= isovalue && bounds.highest > isovalue;
}

using BrickValues = std::array<float, kBrickVoxels>;

BrickValues valuesOf(const Volume& volume, const Vec3i& brick) {
  BrickValues values{};
  if (volume.readBrick(brick, values.data())) values.fill(values[0]);
  return values;
}

VoxelBox boxOf(const BrickGrid& grid, std::uint32_t brick) {
  const Vec3i first = grid.brick(brick) * kBrickSize;
  return {first, (first + Vec3i::Constant(kBrickSize - 1)).cwiseMin(grid.size - Vec3i::Ones())};
}

VoxelBox intersection(const VoxelBox& a, const VoxelBox& b) {
  return {a.first.cwiseMax(b.first), a.last.cwiseMin(b.last)};
}

VoxelBox widened(const VoxelBox& box, const Vec3i& by, const BrickGrid& grid) {
  return {(box.first - by).cwiseMax(Vec3i::Zero()), (box.last + by).cwiseMin(grid.size - Vec3i::Ones())};
}

VoxelBox hull(const VoxelBox& a, const VoxelBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {a.first.cwiseMin(b.first), a.last.cwiseMax(b.last)};
}

template <typename Visit>
void forEachCorner(const BrickGrid& grid, const Vec3i& brick, int step, const Visit& visit) {
  const Vec3i counts = grid.counts();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3i other = brick + step * Vec3i(corner & 1, corner >> 1 & 1, corner >> 2);
    if (other.minCoeff() >= 0 && (other.array() < counts.array()).all()) visit(grid.index(other));
  }
}

Vec3i reachOf(const FilterChain* chain) {
  return chain != nullptr ? chain->reach() : Vec3i::Zero();
}

std::uint32_t dispatchesOf(const FilterChain* chain) {
  return chain != nullptr ? chain->dispatches() : 0;
}

std::vector<EditPhase> phasesOf(const LoweredEdits& edits) {
  std::vector<EditPhase> phases;
  for (std::uint32_t i = 0; i < edits.commands.size(); ++i) {
    const layout::uint kind = edits.commands[i].kind;
    if (phases.empty() || phases.back().kind != kind || phases.back().stencil())
      phases.push_back({kind, false, i, 0, {}});
    ++phases.back().command_count;
  }
  return phases;
}

}  // namespace

Editor::Editor(const Parts& parts, const BrushProfile& profile, bool all_samples)
    : parts_(parts),
      profile_(profile),
      grid_{parts.pool.size(), parts.pool.lattice().spacing_m},
      all_samples_(all_samples),
      edit_(parts.gpu, parts.pool),
      tasks_(parts.gpu, "brick tasks", 1024),
      bound_tasks_(parts.gpu, "bounds tasks", 1024),
      bound_results_(parts.gpu, "edited bounds", 1024),
      touched_values_(parts.gpu, "touched bricks", 1, std::numeric_limits<std::uint64_t>::max()),  // copied, not bound
      max_dispatches_(64),
      is_changed_(parts.pool.brickCount()) {
  commands_.emplace(parts.gpu, "edit", max_dispatches_);
  makeSpareRoom();
  if (all_samples) return;
  crossed_.reserve(parts.pool.brickCount());
  for (const layout::BrickBounds& bounds : parts.bounds->read(parts.transfer))
    crossed_.push_back(crosses(bounds, parts.isovalue));
}

Editor::~Editor() = default;

// A wish: where there is no room for it, an edit that needs some says so.
void Editor::makeSpareRoom() {
  try {
    parts_.pool.reserve(std::min(parts_.pool.brickCount() - parts_.pool.storedBricks(), kSpareBricks));
    for (FilterChain* chain : {parts_.filters, parts_.smoothing})
      if (chain != nullptr) chain->reserve(kSpareBricks);
    if (all_samples_) return;
    parts_.store.reserve(std::min(parts_.pool.brickCount() - parts_.store.brickCount(), kSpareBricks));
  } catch (const Error& error) {
    if (error.code() != Error::Code::kOutOfMemory) throw;
  }
}

void Editor::prepare(std::span<const EditKind> kinds) {
  if (parts_.filters != nullptr) parts_.filters->prepare();
  if (parts_.smoothing != nullptr) parts_.smoothing->prepare();
  for (const EditKind kind : kinds) {
    commands_->timed(false);
    commands_->begin();
    edit_.recordIdle(*commands_, layoutKind(kind));
    if (parts_.bounds != nullptr) parts_.bounds->record(*commands_, bound_tasks_.buffer(), 0, bound_results_.buffer());
    commands_->run();
  }
}

std::optional<float> Editor::constantOf(const Plan& plan, std::uint32_t brick) const {
  const auto found = plan.touched.find(brick);
  if (found != plan.touched.end()) return found->second.stored ? std::nullopt : std::optional(found->second.constant);
  const layout::BrickPage& page = parts_.pool.page(brick);
  return page.slot == NO_SLOT ? std::optional(page.constant) : std::nullopt;
}

// What a constant brick holds after a phase, if it surely stays constant.
std::optional<float> Editor::stillConstant(const Plan& plan, const EditPhase& phase, std::uint32_t brick,
                                           float density) const {
  if (phase.stencil()) {  // among bricks that hold the same there is nothing to even out or to move
    const Vec3i at = grid_.brick(brick);
    for (int side = 0; side < 6; ++side) {
      const Vec3i other = at + Vec3i::Unit(side / 2) * (side % 2 == 0 ? -1 : 1);
      if (other.minCoeff() < 0 || (other.array() >= grid_.counts().array()).any()) continue;
      const std::optional<float> beside = constantOf(plan, grid_.index(other));
      if (!beside || !sameBits(*beside, density)) return std::nullopt;
    }
    const bool negative_zero = sameBits(density, -0.0F);  // adding nothing to it gives +0
    return negative_zero ? std::nullopt : std::optional(density);
  }
  for (std::uint32_t i = 0; i < phase.command_count; ++i) {
    const std::optional<float> next =
        uniformResult(plan.edits.commands[phase.first_command + i], grid_, brick, density);
    if (!next) return std::nullopt;
    density = *next;
  }
  return density;
}

void Editor::planPhase(Plan& plan, EditPhase& phase) const {
  std::vector<std::uint32_t> bricks;
  std::vector<VoxelBox> boxes;
  for (std::uint32_t i = 0; i < phase.command_count; ++i) {
    const layout::EditCommand& command = plan.edits.commands[phase.first_command + i];
    const std::vector<std::uint32_t> reached = reachedBricks(command, grid_);
    bricks.insert(bricks.end(), reached.begin(), reached.end());
    boxes.push_back(reachedBox(command, grid_));
  }
  if (phase.command_count > 1) sortUnique(bricks);
  // Constant bricks are judged by what their neighbours held before the phase, so the states change after the loop.
  std::vector<std::pair<std::uint32_t, Touched>> states;
  for (const std::uint32_t brick : bricks) {
    const std::optional<float> constant = constantOf(plan, brick);
    Touched state{};
    const auto known = plan.touched.find(brick);
    if (known != plan.touched.end()) state = known->second;
    layout::EditTask task{brick, 0, 0, 0.0F};
    if (constant) {
      const std::optional<float> after = stillConstant(plan, phase, brick, *constant);
      if (after && sameBits(*after, *constant)) continue;
      task = after ? layout::EditTask{brick, NO_SLOT, 0, *after} : layout::EditTask{brick, 0, 1, *constant};
      state.stored = !after;
      state.is_new = !after;
      state.constant = after.value_or(0);
    } else {
      state.stored = true;
    }
    const VoxelBox whole = boxOf(grid_, brick);
    for (const VoxelBox& box : boxes) {
      const VoxelBox part = intersection(whole, box);
      if (!part.empty()) state.changed = hull(state.changed, part);
    }
    if (state.changed.empty()) state.changed = whole;
    for (std::uint32_t i = 0; i < phase.command_count; ++i) {
      if (mayCross(plan.edits.commands[phase.first_command + i], grid_, brick)) state.may_cross = true;
    }
    phase.tasks.push_back(task);
    states.emplace_back(brick, state);
  }
  for (const auto& [brick, state] : states) plan.touched[brick] = state;
}

void Editor::planReach(Plan& plan) const {
  std::vector<std::uint32_t> crossable;  // bricks whose cells the isosurface may cross from now on, or no longer
  for (const auto& [brick, state] : plan.touched) {
    const VoxelBox altered = widened(state.changed, reachOf(parts_.filters), grid_);
    const VoxelBox smoothed = widened(altered, reachOf(parts_.smoothing), grid_);  // holds all of `altered`
    appendReached(grid_, altered, Reach{}, plan.altered);
    if (parts_.smoothing != nullptr) appendReached(grid_, smoothed, Reach{}, plan.smoothed);
    appendReached(grid_, altered, kBoundsReach, plan.rebounded);
    appendReached(grid_, smoothed, parts_.gradient.reach(), plan.regraded);
    if (state.may_cross || parts_.filters != nullptr) appendReached(grid_, altered, kBoundsReach, crossable);
    plan.new_bricks += state.is_new ? 1 : 0;
  }
  sortUnique(plan.altered);
  sortUnique(plan.smoothed);
  sortUnique(crossable);
  sortUnique(plan.rebounded);
  sortUnique(plan.regraded);
  if (all_samples_) return;
  for (const std::uint32_t brick : crossable) {
    forEachCorner(grid_, grid_.brick(brick), 1, [&](std::uint32_t other) { plan.unsettled.push_back(other); });
  }
  sortUnique(plan.unsettled);
  const auto has = [&](std::uint32_t brick) { return parts_.store.has(brick); };
  std::copy_if(plan.unsettled.begin(), plan.unsettled.end(), std::back_inserter(plan.newly),
               [&](std::uint32_t brick) { return !has(brick); });
  plan.regraded.erase(std::remove_if(plan.regraded.begin(), plan.regraded.end(), std::not_fn(has)),
                      plan.regraded.end());
}

Editor::Plan Editor::makePlan(std::span<const EditCommand> commands) const {
  Plan plan;
  plan.edits = lowerEdits(commands, parts_.pool.size(), parts_.pool.lattice(), profile_);
  plan.phases = phasesOf(plan.edits);
  for (EditPhase& phase : plan.phases) planPhase(plan, phase);
  planReach(plan);
  return plan;
}

// A phase that writes pages of bricks that are given one value, and one that puts densities in place.
Editor::Plan Editor::makePlan(std::span<const BrickContent> bricks) const {
  Plan plan;
  EditPhase pages;
  EditPhase given;
  given.given = true;
  for (const BrickContent& content : bricks) {
    const bool is_constant = content.values.size() == 1;
    const bool known = content.brick < parts_.pool.brickCount() && !plan.touched.contains(content.brick);
    const bool finite =
        std::all_of(content.values.begin(), content.values.end(), [](float v) { return std::isfinite(v); });
    if (!known || !finite || (!is_constant && content.values.size() != kBrickVoxels)) {
      throw Error(Error::Code::kBadInput, fmt::format("brick {}", content.brick),
                  "it is not in the volume, comes twice, or has other than 1 or 512 finite densities",
                  "give each brick of the volume at most once");
    }
    const layout::BrickPage& page = parts_.pool.page(content.brick);
    const bool was_constant = page.slot == NO_SLOT;
    if (is_constant && was_constant && sameBits(page.constant, content.values[0])) continue;
    // Between two constants the isovalue may lie or not; of others nothing is known.
    const bool may_cross =
        !is_constant || !was_constant || (page.constant > parts_.isovalue) != (content.values[0] > parts_.isovalue);
    Touched state{!is_constant, !is_constant && was_constant, is_constant ? content.values[0] : 0.0F,
                  boxOf(grid_, content.brick), may_cross};
    if (is_constant) {
      pages.tasks.push_back({content.brick, NO_SLOT, 0, content.values[0]});
      if (!was_constant) plan.emptied.push_back(content.brick);
    } else {
      given.tasks.push_back({content.brick, 0, was_constant ? 1U : 0U, page.constant});
    }
    plan.touched[content.brick] = state;
  }
  plan.phases = {std::move(pages), std::move(given)};
  planReach(plan);
  return plan;
}

// Where the budget is short, the message is about the whole edit, densities and samples.
void Editor::makeBrickRoom(const Plan& plan) {
  try {
    parts_.pool.reserve(plan.new_bricks);
    parts_.store.reserve(plan.newly.size());
  } catch (const Error& error) {
    const GpuBudget& budget = *parts_.pool.budget();
    const std::uint64_t densities = parts_.pool.bytesToReserve(plan.new_bricks);
    const std::uint64_t samples = parts_.store.bytesToReserve(plan.newly.size());
    if (error.code() != Error::Code::kOutOfMemory || densities + samples <= budget.leftBytes()) throw;
    throw Error(error.code(), "GPU memory for the edit",
                fmt::format("the volume, as edited until now, takes {}, the edit needs {} more ({} for densities, {} "
                            "for samples), and the budget is {}",
                            inMiB(budget.used_bytes), inMiB(densities + samples), inMiB(densities), inMiB(samples),
                            inMiB(budget.limit_bytes)),
                fmt::format("nothing was changed; raise --gpu-memory to {} or more, or use a smaller brush",
                            wholeMiB(budget.used_bytes + densities + samples)));
  }
}

// All that may fail for want of memory comes here, kernels included: then nothing has changed.
void Editor::makeRoom(const Plan& plan) {
  edit_.fit(plan.phases, plan.edits, parts_.pool.stalePages());
  if (plan.phases.back().given) edit_.fitGiven(plan.phases.back().tasks.size());
  makeBrickRoom(plan);
  if (parts_.filters != nullptr)
    parts_.filters->plan(plan.altered, [&](std::uint32_t brick) { return constantOf(plan, brick); });
  if (parts_.smoothing != nullptr) {
    parts_.smoothing->plan(plan.smoothed, [&](std::uint32_t brick) {
      return parts_.filters != nullptr ? parts_.filters->constantAfter(brick) : constantOf(plan, brick);
    });
  }
  tasks_.fit(plan.regraded.size() + plan.newly.size() + WindowPass::kMaxTasks);
  bound_tasks_.fit(plan.rebounded.size());
  bound_results_.fit(plan.rebounded.size());
  if (!parts_.transfer.reaches(parts_.pool.slab(0))) {
    const auto is_stored = [](const auto& touched) { return touched.second.stored; };
    const auto stored = std::count_if(plan.touched.begin(), plan.touched.end(), is_stored);
    touched_values_.fit(static_cast<std::size_t>(stored) * kBrickVoxels);
  }
  const auto slabs = static_cast<std::uint32_t>(parts_.store.slabCount());
  // One phase more for pages; bounds; a range for each slab of gradients, and for the window.
  const auto window = static_cast<std::uint32_t>(WindowPass::kMaxTasks);
  const std::uint32_t dispatches = edit_.dispatches(plan.phases) + DENSITY_SLABS + 2 + slabs + std::min(slabs, window) +
                                   dispatchesOf(parts_.filters) + dispatchesOf(parts_.smoothing);
  if (dispatches > max_dispatches_) {
    commands_ = gpu::Commands(parts_.gpu, "edit", 2 * dispatches);  // the old ones stay where this throws
    max_dispatches_ = 2 * dispatches;
  }
  makeKernels(plan);
}

// Those that read a pool depend on its slabs, so this comes when all room is made.
void Editor::makeKernels(const Plan& plan) {
  edit_.makeKernels(plan.phases);
  if (parts_.filters != nullptr) parts_.filters->makeKernels();
  if (parts_.smoothing != nullptr) parts_.smoothing->makeKernels();
  if (parts_.bounds != nullptr) parts_.bounds->makeKernels();
  parts_.gradient.makeKernels();
  parts_.window.makeKernels();
}

void Editor::handOutSlots(Plan& plan) {
  writeStalePages(plan);
  for (const std::uint32_t brick : plan.emptied) parts_.pool.empty(brick);
  for (const auto& [brick, state] : plan.touched) {
    if (state.is_new) parts_.pool.store(brick);
    if (!state.stored) parts_.pool.setConstant(brick, state.constant);
  }
  for (EditPhase& phase : plan.phases) {
    for (layout::EditTask& task : phase.tasks) {
      if (task.slot != NO_SLOT) task.slot = parts_.pool.page(task.brick).slot;
    }
  }
  for (const std::uint32_t brick : plan.newly) parts_.store.add(brick, besideWithSamples(brick));
  if (parts_.filters != nullptr) parts_.filters->commit();
  if (parts_.smoothing != nullptr) parts_.smoothing->commit();
}

// Pages that became stale since the last edit are written before anything else: in the first phase, unless that reads
// other bricks' pages. Before this edit's slots are handed out: pages here still say what the bricks hold now.
void Editor::writeStalePages(Plan& plan) {
  const std::vector<std::uint32_t> stale = parts_.pool.takeStalePages();
  if (stale.empty()) return;
  if (plan.phases.front().stencil()) plan.phases.insert(plan.phases.begin(), EditPhase{});
  EditPhase& first = plan.phases.front();
  std::unordered_set<std::uint32_t> written;  // bricks that this phase works on get their pages from that
  for (const layout::EditTask& task : first.tasks) written.insert(task.brick);
  for (const std::uint32_t brick : stale) {
    const layout::BrickPage& page = parts_.pool.page(brick);
    if (page.slot == NO_SLOT && written.insert(brick).second) first.tasks.push_back({brick, NO_SLOT, 0, page.constant});
  }
}

bool Editor::reachesWindow(const Plan& plan, const WindowBox& box) const {
  const VoxelBox window{box.first, box.first + box.size - Vec3i::Ones()};
  const auto overlaps = [&](const VoxelBox& other) { return !intersection(window, other).empty(); };
  const auto holds = [&](std::uint32_t brick) { return overlaps(boxOf(grid_, brick)); };
  if (std::any_of(plan.unsettled.begin(), plan.unsettled.end(), holds)) return true;
  return std::any_of(plan.regraded.begin(), plan.regraded.end(), holds) ||
         std::any_of(plan.altered.begin(), plan.altered.end(), holds);
}

void Editor::record(Plan& plan, const WindowTarget* target, Outcome& outcome) {
  gpu::Commands& commands = *commands_;
  BrickTasks gradient;
  for (const std::uint32_t brick : plan.regraded) gradient.add(brick, parts_.store.place(brick));
  for (const std::uint32_t brick : plan.newly) gradient.add(brick, parts_.store.place(brick), true);
  std::vector<layout::BrickTask> list;
  const std::vector<TaskRange> gradient_ranges = gradient.moveTo(list);
  outcome.gradient_bricks = list.size();
  std::vector<TaskRange> window_ranges;
  outcome.window_gathered = target != nullptr && reachesWindow(plan, target->box);
  if (outcome.window_gathered) {
    const auto among = [](const std::vector<std::uint32_t>& bricks, std::size_t brick) {
      return std::binary_search(bricks.begin(), bricks.end(), static_cast<std::uint32_t>(brick));
    };
    const auto unsure = [&](std::size_t brick) { return among(plan.unsettled, brick); };
    const auto stale = [&](std::size_t brick) {
      return target->previous == nullptr || unsure(brick) || among(plan.regraded, brick) || among(plan.altered, brick);
    };
    window_ranges = parts_.window.tasksOf(target->box, stale, unsure).moveTo(list);
    if (target->previous != nullptr) {
      const auto samples = static_cast<std::size_t>(target->box.size.prod());
      std::memcpy(target->buffer->mapped(), target->previous->mapped(), samples * sizeof(Sample));
    }
  }
  std::vector<layout::BrickTask> bounds_list;
  for (const std::uint32_t brick : plan.rebounded) bounds_list.push_back({brick, NO_SLOT});

  commands.timed(times_kernels_);
  commands.begin();
  edit_.write(plan.phases, plan.edits);
  tasks_.write(list);
  bound_tasks_.write(bounds_list);
  edit_.record(commands, plan.phases);
  commands.mark("edit");
  if (parts_.filters != nullptr) {
    parts_.filters->record(commands);
    commands.mark("filter");
  }
  if (parts_.smoothing != nullptr) {
    parts_.smoothing->record(commands);
    commands.mark("smoothing");
  }
  ActiveTest test{nullptr, parts_.isovalue};
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

// Where the host cannot reach the slabs, touched bricks are copied to where it can.
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

Editor::Outcome Editor::apply(std::span<const EditCommand> commands, const WindowTarget* target) {
  refuseIfBroken();
  settle();
  const auto start = Clock::now();
  Plan plan = makePlan(commands);
  return run(plan, target, {}, secondsSince(start));
}

Editor::Outcome Editor::replace(std::span<const BrickContent> bricks, const WindowTarget* target) {
  refuseIfBroken();
  settle();
  const auto start = Clock::now();
  Plan plan = makePlan(bricks);
  return run(plan, target, bricks, secondsSince(start));
}

Editor::Outcome Editor::run(Plan& plan, const WindowTarget* target, std::span<const BrickContent> given,
                            double planned_s) {
  Outcome outcome;
  outcome.changed_bricks = plan.touched.size();
  if (plan.touched.empty()) {  // nothing within reach that the commands would change
    outcome.version = ++version_;
    return outcome;
  }
  const auto making_room = Clock::now();
  try {
    makeRoom(plan);
  } catch (...) {
    for (FilterChain* chain : {parts_.filters, parts_.smoothing})
      if (chain != nullptr) chain->abandon();
    throw;
  }
  outcome.stages.push_back({"plan", planned_s + secondsSince(making_room)});

  const auto recording = Clock::now();
  broken_ = true;  // from here on pages and slots say what holds only once the device has done its part
  handOutSlots(plan);
  stored_.clear();
  for (const auto& [brick, state] : plan.touched) {
    if (state.stored) stored_.push_back(brick);
    noteChanged(brick);
  }
  record(plan, target, outcome);
  handOver(plan, given);
  downloadTouched();
  outcome.stages.push_back({"record", secondsSince(recording)});

  const auto computing = Clock::now();
  commands_->run();
  broken_ = false;
  outcome.stages.push_back({"gpu", secondsSince(computing)});
  for (StageTime& stage : commands_->marks()) outcome.stages.push_back(std::move(stage));
  rebounded_ = std::move(plan.rebounded);
  unsettled_ = std::move(plan.unsettled);
  settled_ = false;
  outcome.version = ++version_;
  return outcome;
}

// Tasks were sorted by their slabs, so the densities follow them.
void Editor::handOver(const Plan& plan, std::span<const BrickContent> given) {
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

Editor::BrickContent Editor::content(std::uint32_t brick) const {
  refuseIfBroken();
  return read(brick);
}

Editor::BrickContent Editor::read(std::uint32_t brick) const {
  std::array<float, kBrickVoxels> values{};
  const bool is_constant = parts_.pool.readBrick(parts_.transfer, brick, values.data());
  return {brick, {values.begin(), is_constant ? values.begin() + 1 : values.end()}};
}

std::vector<std::uint32_t> Editor::bricksToChange(std::span<const EditCommand> commands) const {
  std::vector<std::uint32_t> bricks;
  for (const auto& [brick, state] : makePlan(commands).touched) bricks.push_back(brick);
  sortUnique(bricks);
  return bricks;
}

// A brick next to this one, in whose slab its samples should lie.
std::optional<std::size_t> Editor::besideWithSamples(std::uint32_t brick) const {
  const Vec3i at = grid_.brick(brick);
  for (int side = 0; side < 6; ++side) {
    const Vec3i other = at + Vec3i::Unit(side / 2) * (side % 2 == 0 ? -1 : 1);
    if (other.minCoeff() < 0 || (other.array() >= grid_.counts().array()).any()) continue;
    if (parts_.store.has(grid_.index(other))) return grid_.index(other);
  }
  return std::nullopt;
}

bool Editor::isActive(std::uint32_t brick) const {
  bool active = false;
  forEachCorner(grid_, grid_.brick(brick), -1, [&](std::uint32_t other) { active = active || crossed_[other]; });
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
  if (parts_.filters != nullptr) parts_.filters->settle();
  if (parts_.smoothing != nullptr) parts_.smoothing->settle();
  if (all_samples_) return;
  const auto bounds = bound_results_.read(rebounded_.size());
  for (std::size_t i = 0; i < rebounded_.size(); ++i) crossed_[rebounded_[i]] = crosses(bounds[i], parts_.isovalue);
  for (const std::uint32_t brick : unsettled_) {
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
    if (std::memcmp(before.data(), after.data(), sizeof before) != 0) ++count;
    is_changed_[brick] = false;
  }
  changed_.clear();
  return count;
}

std::vector<Editor::BrickContent> Editor::takeChanged(std::size_t most) {
  refuseIfBroken();
  settle();
  broken_ = true;  // bricks that were taken and not handed over would be missing in every later file
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
