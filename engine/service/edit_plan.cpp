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

std::optional<std::size_t> neighbourWithSamples(const BrickGrid& grid, const SampleStore& store, std::uint32_t brick) {
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

// The density of a constant brick after a phase, if it surely stays constant.
std::optional<float> EditPlanner::stillConstant(const EditPlan& plan, const EditPhase& phase, std::uint32_t brick,
                                                float density) const {
  if (phase.stencil()) {                    // neighbours of equal density: nothing to smooth or to move
    bool even = !sameBits(density, -0.0F);  // -0 plus 0 is +0
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
  // Whether a brick stays constant depends on what its neighbours held before the phase. So the states change after the
  // loop.
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

// Brushes put their surface where the field has the profile's isovalue, and mayCross() is about that surface. If
// filters come after, or another isovalue is felt, the isosurface may be anywhere in the changed region.
bool EditPlanner::isBrushSurfaceFelt() const {
  const auto put = static_cast<float>(profile_.isovalue);
  return !scope_.filter_reach && scope_.isovalues.felt == put && scope_.isovalues.other == put;
}

void EditPlanner::planReach(EditPlan& plan) const {
  const bool anywhere = !isBrushSurfaceFelt();
  std::vector<std::uint32_t> crossable;  // bricks whose cells the isosurface may begin or cease to cross
  for (const auto& [brick, state] : plan.touched) {
    const VoxelBox altered = grid_.widened(state.changed, scope_.filter_reach.value_or(Vec3i::Zero()));
    const VoxelBox smoothed =
        grid_.widened(altered, scope_.smoothing_reach.value_or(Vec3i::Zero()));  // contains `altered`
    appendReached(grid_, altered, Reach{}, plan.altered);
    if (scope_.smoothing_reach) appendReached(grid_, smoothed, Reach{}, plan.smoothed);
    appendReached(grid_, altered, kBoundsReach, plan.bounds_stale);
    appendReached(grid_, smoothed, scope_.gradient_reach, plan.gradients_stale);
    if (state.may_cross || anywhere) appendReached(grid_, altered, kBoundsReach, crossable);
    plan.new_bricks += state.is_new ? 1 : 0;
  }
  sortUnique(plan.altered);
  sortUnique(plan.smoothed);
  sortUnique(crossable);
  sortUnique(plan.bounds_stale);
  sortUnique(plan.gradients_stale);
  if (scope_.all_samples) return;
  for (const std::uint32_t brick : crossable) {
    grid_.forEachAtCorner(grid_.brick(brick), 1, [&](std::uint32_t other) { plan.activity_unsure.push_back(other); });
  }
  sortUnique(plan.activity_unsure);
  const auto has = [&](std::uint32_t brick) { return scope_.store.has(brick); };
  std::copy_if(plan.activity_unsure.begin(), plan.activity_unsure.end(), std::back_inserter(plan.unsampled),
               [&](std::uint32_t brick) { return !has(brick); });
  plan.gradients_stale.erase(std::remove_if(plan.gradients_stale.begin(), plan.gradients_stale.end(), std::not_fn(has)),
                             plan.gradients_stale.end());
}

EditPlan EditPlanner::plan(std::span<const EditCommand> commands) const {
  EditPlan plan;
  plan.edits = lowerEdits(commands, scope_.pool.size(), scope_.pool.lattice(), profile_);
  plan.phases = phasesOf(plan.edits);
  for (EditPhase& phase : plan.phases) planPhase(plan, phase);
  planReach(plan);
  return plan;
}

// Two phases: one writes pages of bricks that become constant, one copies given densities.
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
    // If a brick goes from one constant to another, the isovalue may lie between them. In all other cases it may cross.
    const auto [lowest, highest] = std::minmax(page.constant, content.values[0]);
    const bool may_cross = !is_constant || !was_constant || eitherCrosses(scope_.isovalues, {lowest, highest});
    EditPlan::Touched state{!is_constant, !is_constant && was_constant, is_constant ? content.values[0] : 0.0F,
                            grid_.box(content.brick), may_cross};
    if (is_constant) {
      pages.tasks.push_back({content.brick, NO_SLOT, 0, content.values[0]});
      if (!was_constant) plan.made_constant.push_back(content.brick);
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
