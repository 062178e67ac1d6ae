// SPDX-License-Identifier: Apache-2.0
// engine/service/engine.hpp: runs a plan for one volume on one Vulkan device and publishes windows around the tool.
//
// Thread: one thread at a time: first the one that made it, then the EngineThread, then the first again for the
// picture. The servo's thread uses exchange() only.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/measured.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/filter_chain.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/isosurface_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/plan/plan.hpp"
#include "engine/service/editor.hpp"
#include "engine/volume/volume.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

class Engine {
 public:
  // Opens the device, uploads the volume and computes what the plan asks for. Throws Error. `gpu_memory_bytes`: limit
  // for densities and samples (0: the device's memory); beyond it Error(kOutOfMemory) is thrown. `progress`: gets the
  // pass that is under way and the fraction of it that is done, for the passes that may take long (filters, smoothing,
  // gradients). It may throw to cancel.
  using StartProgress = std::function<void(const char* pass, double done)>;
  Engine(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name,
         std::uint64_t gpu_memory_bytes = 0, const StartProgress& progress = {});
  ~Engine();

  // Gathers and publishes a window around `focus_W` if there is none yet, or if this point has left the middle of the
  // last one. Otherwise confirms that the last one still holds. Returns whether a window was published. `now_ns`: on
  // the servo's clock.
  bool publishAround(const Vec3& focus_W, std::int64_t now_ns);
  // The same, around the point where this tool needs the window (window_focus.hpp).
  bool publishFor(const ToolPose& tool, std::int64_t now_ns);

  // Prepares for edits. Call it once, before the first edit. `kinds`: the kinds of edit whose kernels are compiled now,
  // so that not even the first edit waits for the driver's compiler. Throws Error(kBadInput) if gradients are those of
  // a smoothed field and Plan::edits is false, since that field is gone then. Cost: kernels, and reading back the
  // bounds of every brick.
  void allowEdits(const BrushProfile& profile, std::span<const EditKind> kinds = {});
  struct EditResult {
    std::uint64_t version = 0;  // of the volume: counts edits
    bool published = false;     // a window with the edit was published; false: the edit does not reach the last window
    std::size_t changed_bricks = 0;
    std::size_t gradient_bricks = 0;
    std::vector<StageTime> stages;  // plan, record, gpu (and of that, if timed, its kernels), publish, settle
  };
  // Applies edit commands in their order (engine/service/editor.hpp). Publishes the last window's box anew if they
  // reach it. Throws as Editor::apply does.
  EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns);
  // The same with whole bricks, for undo and replay (Editor::replace).
  EditResult replace(std::span<const BrickContent> bricks, std::int64_t now_ns);
  [[nodiscard]] const Editor& editor() const noexcept { return *editor_; }  // once edits are allowed
  void timeKernels(bool on) { editor_->timeKernels(on); }
  // Brings the bricks that edits changed back into the volume; returns how many of its bricks hold something else now.
  // For idle moments.
  std::size_t readBack(Volume& volume);
  // The same as copies, a part at a time (Editor::takeChanged); once edits are allowed.
  [[nodiscard]] std::vector<BrickContent> takeChanged(std::size_t most) { return editor_->takeChanged(most); }
  [[nodiscard]] std::uint64_t editVersion() const noexcept { return editor_ ? editor_->version() : 0; }

  // The field that is felt: the filtered one, as a volume; only where the plan filters. Cost: a copy of its bricks.
  [[nodiscard]] Volume filtered(const VolumeFacts& facts);
  [[nodiscard]] bool filters() const noexcept { return filters_ != nullptr; }
  // Of the field that is felt: the volume's, or 0 where that is a distance.
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }

  // The plan must draw. `between`: called between bands of rows; what it throws ends the drawing.
  [[nodiscard]] RenderedImage draw(const Camera& camera, const std::function<void()>& between = {});

  [[nodiscard]] WindowExchange& exchange() noexcept { return *exchange_; }
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept { return gpu_.info(); }
  [[nodiscard]] const std::vector<StageTime>& stages() const noexcept { return stages_; }
  [[nodiscard]] std::vector<MemoryFigure> memory() const;
  // Of that, what counts against `gpu_memory_bytes`: densities, filtered and smoothed ones too, and samples, with room
  // to grow.
  [[nodiscard]] std::uint64_t budgetedBytes() const noexcept { return pool_->budget()->used_bytes; }
  [[nodiscard]] PlanFacts planFacts() const noexcept;

 private:
  template <typename Work>
  void stage(const char* name, Work work);
  [[nodiscard]] const BrickPool& field() const noexcept { return filters_ ? filters_->result() : *pool_; }
  void computeGradients(const Volume& volume, const Plan& plan, const StartProgress& progress);
  [[nodiscard]] std::pair<float, float> densityRange(const Volume& volume);
  void makeWindows();
  template <typename Change>
  EditResult change(std::int64_t now_ns, const Change& change);
  void publishBox(const WindowBox& box, std::int64_t now_ns);  // whose samples are gathered

  double isovalue_;  // of the field that is felt
  std::vector<StageTime> stages_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  std::unique_ptr<BrickPool> pool_;       // the volume, which edits change
  std::unique_ptr<FilterChain> filters_;  // from it to the field that is felt; null: none
  std::unique_ptr<BrickBoundsPass> bounds_;
  std::unique_ptr<SampleStore> store_;
  std::unique_ptr<FilterChain> smoothing_;  // from that field to the one whose gradients are taken; null: the same
  std::unique_ptr<GradientPass> gradient_;  // of a smoothed field without edits both are gone once they were used
  std::unique_ptr<WindowPass> window_;
  std::unique_ptr<IsosurfacePass> isosurface_;
  bool gradient_all_ = false;
  std::vector<gpu::Buffer> window_buffers_;  // three, mapped: the exchange's storages
  std::unique_ptr<WindowExchange> exchange_;
  std::optional<WindowBox> published_;  // where the newest window lies
  unsigned published_slot_ = 0;         // and in which buffer
  std::unique_ptr<Editor> editor_;      // once edits are allowed
};

}  // namespace palpate
