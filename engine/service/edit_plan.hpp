// SPDX-License-Identifier: Apache-2.0
// engine/service/edit_plan.hpp: which bricks an edit can change, and all that follows from that, found on the CPU
// before the GPU is asked for anything: what must be edited, filtered, bounded, graded and gathered anew, and what room
// it takes. A constant brick that surely stays constant costs its page only. Changes nothing. Thread: the Gpu's. Cost:
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
    bool stored = false;     // has, or will have, a slot
    bool is_new = false;     // will get one
    float constant = 0;      // if it is not stored
    VoxelBox changed;        // voxels that may change
    bool may_cross = false;  // some may change sides of the isovalue
  };
  LoweredEdits edits;
  std::vector<EditPhase> phases;
  std::unordered_map<std::uint32_t, Touched> touched;
  std::vector<std::uint32_t> altered;    // bricks whose densities may change in the field that is felt
  std::vector<std::uint32_t> smoothed;   // bricks whose smoothed densities may change, where there are such
  std::vector<std::uint32_t> rebounded;  // bricks whose bounds may change
  std::vector<std::uint32_t> unsettled;  // bricks that may become active or cease to be
  std::vector<std::uint32_t> newly;      // of those, without samples until now
  std::vector<std::uint32_t> regraded;   // bricks with samples whose gradients may change
  std::vector<std::uint32_t> emptied;    // stored bricks that are given one value
  std::size_t new_bricks = 0;
};

class EditPlanner {
 public:
  // What edits meet. Pool and samples outlive the planner.
  struct Scope {
    const BrickPool& pool;
    const SampleStore& store;
    std::optional<Vec3i> filter_reach;     // of the chain between the pool and the field that is felt, if there is one
    std::optional<Vec3i> smoothing_reach;  // of the one between that field and its gradients
    Reach gradient_reach;
    float isovalue = 0;        // of the field that is felt [density]
    bool all_samples = false;  // every brick has samples, whatever its bounds
  };
  EditPlanner(const Scope& scope, const BrushProfile& profile);

  // Throws as lowerEdits does.
  [[nodiscard]] EditPlan plan(std::span<const EditCommand> commands) const;
  // Of bricks that are put in place whole. Throws Error(kBadInput) as Editor::replace says.
  [[nodiscard]] EditPlan plan(std::span<const BrickContent> bricks) const;

  // What a brick holds after what is planned so far, if it is constant then.
  [[nodiscard]] std::optional<float> constantAfter(const EditPlan& plan, std::uint32_t brick) const;

 private:
  void planPhase(EditPlan& plan, EditPhase& phase) const;
  [[nodiscard]] std::optional<float> stillConstant(const EditPlan& plan, const EditPhase& phase, std::uint32_t brick,
                                                   float density) const;
  void planReach(EditPlan& plan) const;

  Scope scope_;
  BrushProfile profile_;
  BrickGrid grid_;
};

}  // namespace palpate
