// SPDX-License-Identifier: Apache-2.0
#include "engine/service/edit_plan.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/brick_values.hpp"

namespace palpate {
namespace {

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

std::optional<std::size_t> besideWithSamples(const BrickGrid& grid, const SampleStore& store, std::uint32_t brick) {
  std::optional<std::size_t> found;
  grid.forEachBeside(grid.brick(brick), [&](std::uint32_t other) {
    if (!found && store.has(other)) found = other;
  });
  return found;
}

EditPlanner::EditPlanner(const Scope& scope, const BrushProfile& profile)
    : scope_(scope), profile_(profile), grid_(scope.pool.grid()) {}

std::optional<float> EditPlanner::constantAfter(const EditPlan& plan, std::uint32_t brick) const {
  const auto found = plan.touched.find(brick);
  if (found != plan.touched.end()) return found->second.stored ? std::nullopt : std::optional(found->second.constant);
  return scope_.pool.constantOf(brick);
}

// What a constant brick holds after a phase, if it surely stays constant.
std::optional<float> EditPlanner::stillConstant(const EditPlan& plan, const EditPhase& phase, std::uint32_t brick,
                                                float density) const {
  if (phase.stencil()) {                    // among bricks that hold the same there is nothing to even out or to move
    bool even = !sameBits(density, -0.0F);  // adding nothing to that gives +0
    grid_.forEachBeside(grid_.brick(brick), [&](std::uint32_t other) {
      const std::optional<float> beside = constantAfter(plan, other);
      even = even && beside && sameBits(*beside, density);
    });
    return even ? std::optional(density) : std::nullopt;
  }
  for (std::uint32_t i = 0; i < phase.command_count; ++i) {
    const std::optional<float> next =
        uniformResult(plan.edits.commands[phase.first_command + i], grid_, brick, density);
    if (!next) return std::nullopt;
    density = *next;
  }
  return density;
}

void EditPlanner::planPhase(EditPlan& plan, EditPhase& phase) const {
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
  std::vector<std::pair<std::uint32_t, EditPlan::Touched>> states;
  for (const std::uint32_t brick : bricks) {
    const std::optional<float> constant = constantAfter(plan, brick);
    EditPlan::Touched state{};
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
    const VoxelBox whole = grid_.box(brick);
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

// Brushes put their surface where the field has the profile's isovalue, and mayCross() is about that surface. Behind
// filters, or where another isovalue is felt, the isosurface may come to lie anywhere in what they change.
bool EditPlanner::isFeltWhereBrushesPut() const {
  const auto put = static_cast<float>(profile_.isovalue);
  return !scope_.filter_reach && scope_.isovalues.felt == put && scope_.isovalues.other == put;
}

void EditPlanner::planReach(EditPlan& plan) const {
  const bool anywhere = !isFeltWhereBrushesPut();
  std::vector<std::uint32_t> crossable;  // bricks whose cells the isosurface may cross from now on, or no longer
  for (const auto& [brick, state] : plan.touched) {
    const VoxelBox altered = grid_.widened(state.changed, scope_.filter_reach.value_or(Vec3i::Zero()));
    const VoxelBox smoothed =
        grid_.widened(altered, scope_.smoothing_reach.value_or(Vec3i::Zero()));  // holds all of `altered`
    appendReached(grid_, altered, Reach{}, plan.altered);
    if (scope_.smoothing_reach) appendReached(grid_, smoothed, Reach{}, plan.smoothed);
    appendReached(grid_, altered, kBoundsReach, plan.rebounded);
    appendReached(grid_, smoothed, scope_.gradient_reach, plan.regraded);
    if (state.may_cross || anywhere) appendReached(grid_, altered, kBoundsReach, crossable);
    plan.new_bricks += state.is_new ? 1 : 0;
  }
  sortUnique(plan.altered);
  sortUnique(plan.smoothed);
  sortUnique(crossable);
  sortUnique(plan.rebounded);
  sortUnique(plan.regraded);
  if (scope_.all_samples) return;
  for (const std::uint32_t brick : crossable) {
    grid_.forEachAtCorner(grid_.brick(brick), 1, [&](std::uint32_t other) { plan.unsettled.push_back(other); });
  }
  sortUnique(plan.unsettled);
  const auto has = [&](std::uint32_t brick) { return scope_.store.has(brick); };
  std::copy_if(plan.unsettled.begin(), plan.unsettled.end(), std::back_inserter(plan.newly),
               [&](std::uint32_t brick) { return !has(brick); });
  plan.regraded.erase(std::remove_if(plan.regraded.begin(), plan.regraded.end(), std::not_fn(has)),
                      plan.regraded.end());
}

EditPlan EditPlanner::plan(std::span<const EditCommand> commands) const {
  EditPlan plan;
  plan.edits = lowerEdits(commands, scope_.pool.size(), scope_.pool.lattice(), profile_);
  plan.phases = phasesOf(plan.edits);
  for (EditPhase& phase : plan.phases) planPhase(plan, phase);
  planReach(plan);
  return plan;
}

// A phase that writes pages of bricks that are given one value, and one that puts densities in place.
EditPlan EditPlanner::plan(std::span<const BrickContent> bricks) const {
  EditPlan plan;
  EditPhase pages;
  EditPhase given;
  given.given = true;
  for (const BrickContent& content : bricks) {
    const bool is_constant = content.values.size() == 1;
    const bool known = content.brick < scope_.pool.brickCount() && !plan.touched.contains(content.brick);
    const bool finite =
        std::all_of(content.values.begin(), content.values.end(), [](float v) { return std::isfinite(v); });
    if (!known || !finite || (!is_constant && content.values.size() != kBrickVoxels)) {
      throw Error(Error::Code::kBadInput, fmt::format("brick {}", content.brick),
                  "it is not in the volume, comes twice, or has other than 1 or 512 finite densities",
                  "give each brick of the volume at most once");
    }
    const layout::BrickPage& page = scope_.pool.page(content.brick);
    const bool was_constant = page.slot == NO_SLOT;
    if (is_constant && was_constant && sameBits(page.constant, content.values[0])) continue;
    // Between two constants an isovalue may lie or not; of others nothing is known.
    const auto [lowest, highest] = std::minmax(page.constant, content.values[0]);
    const bool may_cross = !is_constant || !was_constant || eitherCrosses(scope_.isovalues, {lowest, highest});
    EditPlan::Touched state{!is_constant, !is_constant && was_constant, is_constant ? content.values[0] : 0.0F,
                            grid_.box(content.brick), may_cross};
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

}  // namespace palpate
