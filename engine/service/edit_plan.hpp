// SPDX-License-Identifier: Apache-2.0
// engine/service/edit_plan.hpp: plans an edit on the CPU, before any work goes to the GPU: which bricks the edit can
// change, for which bricks filters, bounds and gradients must be computed anew, and how much room that takes. A
// constant brick that surely stays constant costs a page only. Planning changes nothing. Thread: the Gpu's. Cost:
// follows the edit.
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
    bool stored = false;     // it has, or will get, a slot
    bool is_new = false;     // it will get a slot
    float constant = 0;      // its density after the edit, if it is not stored
    VoxelBox changed;        // voxels that may change
    bool may_cross = false;  // some of them may cross the isovalue
  };
  LoweredEdits edits;
  std::vector<EditPhase> phases;
  std::unordered_map<std::uint32_t, Touched> touched;
  std::vector<std::uint32_t> altered;    // bricks whose densities may change in the field that is felt
  std::vector<std::uint32_t> smoothed;   // bricks whose smoothed densities may change, if gradients are smoothed
  std::vector<std::uint32_t> rebounded;  // bricks whose bounds may change
  std::vector<std::uint32_t> unsettled;  // bricks that may become active or inactive (bricks/active_bricks.hpp)
  std::vector<std::uint32_t> newly;      // of those, the bricks without samples until now
  std::vector<std::uint32_t> regraded;   // bricks with samples whose gradients may change
  std::vector<std::uint32_t> emptied;    // stored bricks that replace() makes constant
  std::size_t new_bricks = 0;            // bricks that will get a slot
};

class EditPlanner {
 public:
  // What edits work on. Pool and samples outlive the planner.
  struct Scope {
    const BrickPool& pool;
    const SampleStore& store;
    std::optional<Vec3i> filter_reach;     // of the chain from the pool to the field that is felt; empty: no chain
    std::optional<Vec3i> smoothing_reach;  // of the chain from that field to its gradients; empty: no chain
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
  [[nodiscard]] bool isFeltWhereBrushesPut() const;

  Scope scope_;
  BrushProfile profile_;
  BrickGrid grid_;
};

// A brick next to this one that has samples, in whose slab its own should lie; empty: there is none.
[[nodiscard]] std::optional<std::size_t> besideWithSamples(const BrickGrid& grid, const SampleStore& store,
                                                           std::uint32_t brick);

}  // namespace palpate
