// SPDX-License-Identifier: Apache-2.0
// engine/service/editor.hpp: edits the volume on the GPU and recomputes only what the edit can reach.
//
// apply() plans on the CPU which bricks the commands can change, and makes room for them. It then records one command
// list: edit, filters, smoothing, bounds, gradients, window. Only the GPU knows which bricks are active after the edit,
// that is, which bricks the isosurface needs. So every brick that may become active gets a sample slot beforehand, and
// the kernels decide by the brick's bounds.
//
// settle() is called once the window has been published. It frees what was not needed: sample slots of bricks that are
// not active, storage of bricks that became constant. After settle(), bricks, bounds and samples equal, bit for bit,
// those of a new start from the edited volume.
//
// Thread: the Gpu's. Cost: depends on the edit. A cut also examines every page of its half space.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/measured.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/edit_pass.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/service/brick_content.hpp"
#include "engine/service/edit_plan.hpp"

namespace palpate {

class Editor {
 public:
  // What edits work on. All of it must outlive the editor. `bounds` may be null if every brick has samples.
  struct Parts {
    gpu::Gpu& gpu;
    gpu::Transfer& transfer;
    BrickPool& pool;
    SampleStore& store;
    BrickBoundsPass* bounds;
    GradientPass& gradient;
    WindowPass& window;
    // Computes the field that is felt from `pool`, which edits change. All other parts read that field. Null: `pool` is
    // felt.
    FilterChain* filters = nullptr;
    float isovalue = 0;  // of the field that is felt [density]
    // Computes a smoothed field from the field that is felt; gradients are taken from the smoothed one. Null: gradients
    // are taken from the field that is felt.
    FilterChain* smoothing = nullptr;
  };
  // `all_samples`: every brick has samples, whatever its bounds. `version`: of the volume as it is. Reserves spare room
  // for new bricks if memory allows.
  Editor(const Parts& parts, const BrushProfile& profile, bool all_samples, std::uint64_t version = 0);
  ~Editor();

  // Compiles the kernels of these kinds, so that the first edit of a kind takes no longer than the next. Cost: up to 50
  // ms for each kernel that the driver has not seen before.
  void prepare(std::span<const EditKind> kinds);

  struct WindowTarget {
    WindowBox box;
    const gpu::Buffer* buffer = nullptr;    // MemoryKind::kHost; filled if the edit reaches the box
    const gpu::Buffer* previous = nullptr;  // the box before this edit, source of unchanged samples; null: gather all
  };
  struct Outcome {
    std::uint64_t version = 0;          // number of the edit, from 1
    bool window_gathered = false;       // the target now holds samples of the edited volume
    std::size_t changed_bricks = 0;     // bricks that the commands may have changed
    std::size_t gradient_bricks = 0;    // bricks whose samples may have been recomputed
    std::vector<ChangedBrick> altered;  // whose densities may have changed in the field that is felt
    std::vector<StageTime> stages;      // plan, record, gpu
  };
  // Applies commands one after another. Gathers the window if `target` is given and the edit reaches its box. Blocks
  // until the GPU is done. `before`, if given, is called once the edit is planned, before anything changes.
  //
  // Throws Error(kBadInput) as lowerEdits() does, and Error(kOutOfMemory) if there is no room. Then nothing has changed
  // and the editor can go on. If the device fails during an edit or while changed bricks are taken, the volume on the
  // GPU is unknown. Then broken() is true, and every function that changes or reads the volume throws Error(kDevice).
  Outcome apply(std::span<const EditCommand> commands, const WindowTarget* target, const BeforeChange& before = {});
  // Replaces whole bricks, as undo and replay do. Each brick, by its linear page index (grid()), may come once. Counts
  // as an edit and otherwise behaves as apply(). At most 65536 of the bricks may hold more than one density. Refuses
  // (Error kBadInput) a brick that does not exist or comes twice, and densities that are not finite.
  Outcome replace(std::span<const BrickContent> bricks, const WindowTarget* target);
  [[nodiscard]] bool broken() const noexcept { return broken_; }
  void refuseIfBroken() const;  // throws Error(kDevice)
  [[nodiscard]] const BrickGrid& grid() const noexcept { return grid_; }
  // What a brick holds now. Call it after settle().
  [[nodiscard]] BrickContent content(std::uint32_t brick) const;
  // Whether content() yields 512 densities, not one.
  [[nodiscard]] bool isStored(std::uint32_t brick) const noexcept { return parts_.pool.isStored(brick); }
  // The bricks that apply() may change, in ascending order. Throws as lowerEdits() does. Cost: that of a plan.
  [[nodiscard]] std::vector<std::uint32_t> bricksToChange(std::span<const EditCommand> commands) const;

  // Call it after every apply() and replace(), once the window is published. If omitted, the next change calls it.
  void settle();

  // Writes every brick that may have changed since the last call into `volume`. Returns how many of them differ from
  // what `volume` held, bit for bit. Call it after settle().
  std::size_t readBack(Volume& volume);
  // Takes copies of at most `most` of the same bricks as they are now, for a caller that keeps the volume elsewhere.
  // Once no changed brick is left, that caller has the volume of version(). Call it after settle().
  [[nodiscard]] std::vector<BrickContent> takeChanged(std::size_t most);
  // Neither read back nor taken yet.
  [[nodiscard]] std::size_t changedBricks() const noexcept { return changed_.size(); }

  // From now on a brick is active if either isovalue needs it. `bounds`: the present bounds of every brick. Call it
  // only after settle(). Cost: one test for every brick.
  void setIsovalues(const layout::IsovaluePair& isovalues, std::span<const layout::BrickBounds> bounds);

  // Adds the device's own times for the parts of "gpu" to Outcome::stages: "edit", "filter", "smoothing", "bounds",
  // "gradient", "window".
  void timeKernels(bool on) noexcept { times_kernels_ = on; }

  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  [[nodiscard]] const BrushProfile& profile() const noexcept { return profile_; }

 private:
  // A chain of filters. It computes a field from the volume, or from the field of the chain before it.
  struct Link {
    FilterChain& chain;
    const char* name;                               // of its stage in Outcome::stages
    std::vector<std::uint32_t> EditPlan::*changed;  // bricks of its field that an edit may change
  };
  [[nodiscard]] static std::vector<Link> chainsOf(const Parts& parts);

  Outcome run(EditPlan& plan, const WindowTarget* target, std::span<const BrickContent> given, double planned_s);
  void handOver(const EditPlan& plan, std::span<const BrickContent> given);
  void makeSpareRoom();
  void makeRoom(const EditPlan& plan);
  void makeBrickRoom(const EditPlan& plan);
  void planChains(const EditPlan& plan);
  void makeKernels(const EditPlan& plan);
  void handOutSlots(EditPlan& plan);
  void writeStalePages(EditPlan& plan);
  void record(EditPlan& plan, const WindowTarget* target, Outcome& outcome);
  void downloadTouched();
  [[nodiscard]] BrickContent read(std::uint32_t brick) const;
  [[nodiscard]] bool reachesWindow(const EditPlan& plan, const WindowBox& box) const;
  [[nodiscard]] bool isActive(std::uint32_t brick) const;
  void noteChanged(std::uint32_t brick);

  Parts parts_;
  std::vector<Link> chains_;  // each reads the field of the one before it
  BrushProfile profile_;
  BrickGrid grid_;
  EditPlanner planner_;
  bool all_samples_;
  EditPass edit_;
  HostList<layout::BrickTask> tasks_;  // of the gradients, then of the window
  HostList<layout::BrickTask> bound_tasks_;
  HostList<layout::BrickBounds> bound_results_;
  HostList<float> touched_values_;  // copies of the bricks that an edit touched, if slabs are not mapped
  std::uint32_t max_dispatches_;
  std::optional<gpu::Commands> commands_;
  bool times_kernels_ = false;
  layout::IsovaluePair isovalues_;
  std::vector<bool> crossed_;     // by brick: an isosurface crosses its cells
  std::vector<bool> is_changed_;  // by brick: it is in changed_
  std::vector<std::uint32_t> changed_;
  std::uint64_t version_;
  bool broken_ = false;  // true from the first change of an edit to its end; stays true if the device fails
  // used between apply() and settle()
  std::vector<std::uint32_t> bounds_stale_, activity_unsure_, stored_;
  bool settled_ = true;
};

}  // namespace palpate
