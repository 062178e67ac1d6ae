// SPDX-License-Identifier: Apache-2.0
// engine/service/editor.hpp: changes the volume on the GPU and brings up to date what a change can reach, and no more.
//
// apply() plans on the CPU which bricks the commands can change, makes room for them, and records one list of work:
// edit, filters, smoothing, bounds, gradients, window. Which bricks the isosurface needs after the edit is known on the
// GPU only; so every brick that may become active gets a sample slot beforehand and the kernels ask its bounds.
// settle(), after the window is out, gives back what was not needed: sample slots of bricks that are not active,
// storage of bricks that became constant. After settle() bricks, bounds and samples equal, bit for bit, what a new
// start from the edited volume gives.
//
// Thread: the Gpu's. Cost: follows the edit; a cut also looks at every page of its half space.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/measured.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/edit_pass.hpp"
#include "engine/passes/filter_chain.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/service/brick_content.hpp"
#include "engine/service/edit_plan.hpp"

namespace palpate {

class Editor {
 public:
  // What an edit works on; all of it outlives the editor. `bounds` may be null where every brick has samples.
  struct Parts {
    gpu::Gpu& gpu;
    gpu::Transfer& transfer;
    BrickPool& pool;
    SampleStore& store;
    BrickBoundsPass* bounds;
    GradientPass& gradient;
    WindowPass& window;
    // From `pool`, which is edited, to the field that is felt and that all the others read; null: the pool itself.
    FilterChain* filters = nullptr;
    float isovalue = 0;  // of that field [density]
    // From that field to the one whose gradients are taken; null: that field itself.
    FilterChain* smoothing = nullptr;
  };
  // `all_samples`: every brick has samples, whatever its bounds. Makes some room for bricks to come, if there is any.
  Editor(const Parts& parts, const BrushProfile& profile, bool all_samples);
  ~Editor();

  // Makes the kernels of these kinds ready, so that the first edit of a kind takes no longer than the next: up to 50 ms
  // each where the driver has not seen them before.
  void prepare(std::span<const EditKind> kinds);

  struct WindowTarget {
    WindowBox box;
    const gpu::Buffer* buffer = nullptr;    // kHost memory, filled where the edit reaches the box
    const gpu::Buffer* previous = nullptr;  // the same box before this edit, to copy what stays; null: all is gathered
  };
  struct Outcome {
    std::uint64_t version = 0;        // counts edits from 1
    bool window_gathered = false;     // the target now holds the edited volume
    std::size_t changed_bricks = 0;   // that the commands may have changed
    std::size_t gradient_bricks = 0;  // whose samples were, or may have been, computed
    std::vector<StageTime> stages;    // plan, record, gpu
  };
  // Applies commands one after another. If `target` is given and the edit reaches its box, gathers it. Blocks until the
  // GPU is done. Throws Error(kBadInput) as lowerEdits does and Error(kOutOfMemory) where there is no room; then
  // nothing has changed and the editor goes on working. Where the device fails in the middle of an edit, or reading
  // back, the volume is not known any more: broken() from then on, and all that changes or reads it throws
  // Error(kDevice).
  Outcome apply(std::span<const EditCommand> commands, const WindowTarget* target);
  // Puts whole bricks back, as undo and replay do; each brick once, linear page indices (grid()). Counts as an edit;
  // for all else as apply(). At most 65536 bricks that are not constant at once. Refuses (Error kBadInput) a brick that
  // is not there or comes twice, and densities that are no finite numbers.
  Outcome replace(std::span<const BrickContent> bricks, const WindowTarget* target);
  [[nodiscard]] bool broken() const noexcept { return broken_; }
  void refuseIfBroken() const;  // throws Error(kDevice)
  [[nodiscard]] const BrickGrid& grid() const noexcept { return grid_; }
  // What a brick holds now, in that form. After settle().
  [[nodiscard]] BrickContent content(std::uint32_t brick) const;
  // Whether that will be 512 densities.
  [[nodiscard]] bool isStored(std::uint32_t brick) const noexcept { return parts_.pool.page(brick).slot != NO_SLOT; }
  // The bricks that apply() would change, ascending: what a history must keep. Throws as lowerEdits does.
  [[nodiscard]] std::vector<std::uint32_t> bricksToChange(std::span<const EditCommand> commands) const;

  // Once after every apply() or replace(), when the window is out.
  void settle();

  // Writes every brick that may have changed since the last call into `volume`; returns how many of them hold other
  // densities than it held, bit for bit. After settle().
  std::size_t readBack(Volume& volume);
  // The same as copies, for who keeps the volume elsewhere: at most `most` of those bricks, each as it is now. When
  // none is left, what was taken since the start makes up the volume of version(). After settle().
  [[nodiscard]] std::vector<BrickContent> takeChanged(std::size_t most);
  [[nodiscard]] std::size_t changedBricks() const noexcept { return changed_.size(); }  // not read back yet

  // Adds the device's own times to the stages: "edit", "filter", "smoothing", "bounds", "gradient", "window" of what
  // "gpu" holds.
  void timeKernels(bool on) noexcept { times_kernels_ = on; }

  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  [[nodiscard]] const BrushProfile& profile() const noexcept { return profile_; }

 private:
  Outcome run(EditPlan& plan, const WindowTarget* target, std::span<const BrickContent> given, double planned_s);
  void handOver(const EditPlan& plan, std::span<const BrickContent> given);
  void makeSpareRoom();
  void makeRoom(const EditPlan& plan);
  void makeBrickRoom(const EditPlan& plan);
  void makeKernels(const EditPlan& plan);
  void handOutSlots(EditPlan& plan);
  void writeStalePages(EditPlan& plan);
  void record(EditPlan& plan, const WindowTarget* target, Outcome& outcome);
  void downloadTouched();
  [[nodiscard]] BrickContent read(std::uint32_t brick) const;
  [[nodiscard]] bool reachesWindow(const EditPlan& plan, const WindowBox& box) const;
  [[nodiscard]] std::optional<std::size_t> besideWithSamples(std::uint32_t brick) const;
  [[nodiscard]] bool isActive(std::uint32_t brick) const;
  void noteChanged(std::uint32_t brick);

  Parts parts_;
  BrushProfile profile_;
  BrickGrid grid_;
  EditPlanner planner_;
  bool all_samples_;
  EditPass edit_;
  HostList<layout::BrickTask> tasks_;  // of gradients, then of the window
  HostList<layout::BrickTask> bound_tasks_;
  HostList<layout::BrickBounds> bound_results_;
  HostList<float> touched_values_;  // bricks that were touched, where slabs are not mapped
  std::uint32_t max_dispatches_;
  std::optional<gpu::Commands> commands_;
  bool times_kernels_ = false;
  std::vector<bool> crossed_;     // by brick: the isosurface crosses its cells
  std::vector<bool> is_changed_;  // by brick: not read back yet
  std::vector<std::uint32_t> changed_;
  std::uint64_t version_ = 0;
  bool broken_ = false;  // between the first change of an edit and its end
  // between apply() and settle()
  std::vector<std::uint32_t> rebounded_, unsettled_, stored_;
  bool settled_ = true;
};

}  // namespace palpate
