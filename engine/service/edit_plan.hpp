// SPDX-License-Identifier: Apache-2.0
// engine/service/edit_plan.hpp: plans an edit on the CPU, before any work goes to the GPU. The plan says which bricks
// the edit can change, which of them need new filter results, bounds and gradients, and how much room that takes. A
// constant brick that surely stays constant needs a page only. Planning changes nothing. Thread: the Gpu's. Cost:
// depends on the edit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/edit/edit_reach.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/edit_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/service/brick_content.hpp"

namespace palpate {

struct EditPlan {
  // A brick whose densities may change.
  struct Touched {
    bool stored = false;     // it has or will get a slot in the pool
    bool is_new = false;     // it will get a slot
    float constant = 0;      // its density after the edit, if it is not stored
    VoxelBox changed;        // voxels that may change
    bool may_cross = false;  // some of them may cross the isovalue
  };
  LoweredEdits edits;
  std::vector<EditPhase> phases;
  std::unordered_map<std::uint32_t, Touched> touched;
  std::vector<std::uint32_t> altered;          // bricks whose densities may change in the field that is felt
  std::vector<std::uint32_t> smoothed;         // bricks whose smoothed densities may change, if gradients are smoothed
  std::vector<std::uint32_t> bounds_stale;     // bricks whose bounds may change
  std::vector<std::uint32_t> activity_unsure;  // bricks that may become active or inactive (bricks/active_bricks.hpp)
  std::vector<std::uint32_t> unsampled;        // those of activity_unsure that have no samples yet
  std::vector<std::uint32_t> gradients_stale;  // bricks with samples whose gradients may change
  std::vector<std::uint32_t> made_constant;    // stored bricks that replace() makes constant
  std::size_t new_bricks = 0;                  // bricks that will get a slot
};

class EditPlanner {
 public:
  // What edits work on. The pool and the samples must outlive the planner.
  struct Scope {
    const BrickPool& pool;
    const SampleStore& store;
    std::optional<Vec3i> filter_reach;     // of the filters from the pool to the field that is felt; empty: none
    std::optional<Vec3i> smoothing_reach;  // of the filters from that field to its gradients; empty: none
    Reach gradient_reach;
    layout::IsovaluePair isovalues = {};  // of the field that is felt
    bool all_samples = false;             // every brick has samples, whatever its bounds
  };
  EditPlanner(const Scope& scope, const BrushProfile& profile);
  void setIsovalues(const layout::IsovaluePair& isovalues) { scope_.isovalues = isovalues; }

  // The plan for commands. Throws as lowerEdits does.
  [[nodiscard]] EditPlan plan(std::span<const EditCommand> commands) const;
  // The plan for replacing whole bricks. Throws Error(kBadInput) as Editor::replace does.
  [[nodiscard]] EditPlan plan(std::span<const BrickContent> bricks) const;

  // The one density that a brick will hold after `plan`; empty if it will be stored.
  [[nodiscard]] std::optional<float> constantAfter(const EditPlan& plan, std::uint32_t brick) const;

 private:
  void planPhase(EditPlan& plan, EditPhase& phase) const;
  [[nodiscard]] std::optional<float> stillConstant(const EditPlan& plan, const EditPhase& phase, std::uint32_t brick,
                                                   float density) const;
  void planReach(EditPlan& plan) const;
  [[nodiscard]] bool isBrushSurfaceFelt() const;

  Scope scope_;
  BrushProfile profile_;
  BrickGrid grid_;
};

// A neighbour of the brick that has samples; empty if there is none. New samples of the brick should go into the same
// slab.
[[nodiscard]] std::optional<std::size_t> neighbourWithSamples(const BrickGrid& grid, const SampleStore& store,
                                                              std::uint32_t brick);

}  // namespace palpate
