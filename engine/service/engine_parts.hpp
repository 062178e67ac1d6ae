// SPDX-License-Identifier: Apache-2.0
// engine/service/engine_parts.hpp: the parts of an Engine and the work that they do. Private to engine/service, so that
// users of an Engine see no pass and no buffer. For functions without a comment see Engine's function of the same name.
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
#include "engine/draw/drawing.hpp"
#include "engine/field/volume.hpp"
#include "engine/filter_passes/filter_chain.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/plan/plan.hpp"
#include "engine/service/editor.hpp"
#include "engine/service/engine.hpp"
#include "engine/service/isovalue_change.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

class EngineParts {
 public:
  EngineParts(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name,
              std::uint64_t gpu_memory_bytes, const Engine::StartProgress& progress);
  bool publishAround(const Vec3& focus_W, std::int64_t now_ns);
  bool publishFor(const ToolPose& tool, std::int64_t now_ns);
  void confirmWindow(std::int64_t now_ns) noexcept;
  void forgetWindow() noexcept;
  void allowEdits(const BrushProfile& profile, std::span<const EditKind> kinds, std::uint64_t version);
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns, const BeforeChange& before);
  Engine::EditResult replace(std::span<const BrickContent> bricks, std::int64_t now_ns);
  std::size_t readBack(Volume& volume);
  void beginIsovalue(double isovalue);
  bool gatherIsovalue(std::size_t most, std::int64_t now_ns);
  void endIsovalue(double keep);
  [[nodiscard]] Volume filtered(const VolumeFacts& facts);
  [[nodiscard]] RenderedImage draw(const Camera& camera, const std::function<void()>& between, const DrawStyle& style);
  void show(const Camera& camera, const DrawStyle& style, DrawOrder order);
  bool pollPicture();
  bool drawPiece(double most_s);
  [[nodiscard]] PictureState pictureState() const noexcept { return drawing_ ? drawing_->state() : PictureState{}; }
  void copyPicture(std::vector<layout::PicturePixel>& pixels);
  [[nodiscard]] RenderedImage picture();
  [[nodiscard]] std::vector<layout::BrickBounds> boundsNow();  // of every brick of the field that is felt
  [[nodiscard]] std::vector<MemoryFigure> memory() const;
  [[nodiscard]] bool deviceFailed() const noexcept { return gpu_.failed(); }
  [[nodiscard]] gpu::GpuUse gpuUse() const { return gpu_.use(); }
  [[nodiscard]] PlanFacts planFacts() const noexcept;

  [[nodiscard]] Editor* editor() noexcept { return editor_.get(); }  // null until edits are allowed
  [[nodiscard]] const Editor* editor() const noexcept { return editor_.get(); }
  [[nodiscard]] std::uint64_t editVersion() const noexcept { return editor_ ? editor_->version() : 0; }
  [[nodiscard]] bool filters() const noexcept { return filters_ != nullptr; }
  [[nodiscard]] double isovalue() const noexcept { return isovalue_; }
  [[nodiscard]] bool gradientEverywhere() const noexcept { return gradient_all_; }
  [[nodiscard]] WindowExchange& exchange() noexcept { return *exchange_; }
  void shareWindows(const Engine::SharedWindows& shared);
  [[nodiscard]] std::size_t windowCapacity() const noexcept;
  [[nodiscard]] bool windowsInPlace() const noexcept { return !copies_windows_; }
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept { return gpu_.info(); }
  [[nodiscard]] const std::vector<StageTime>& stages() const noexcept { return stages_; }
  [[nodiscard]] std::uint64_t budgetedBytes() const noexcept { return pool_->budget()->used_bytes; }

 private:
  void checkDraws() const;
  [[nodiscard]] Drawing& shown();
  template <typename Work>
  void stage(const char* name, Work work);
  [[nodiscard]] const BrickPool& field() const noexcept { return filters_ ? filters_->result() : *pool_; }
  void computeGradients(const Volume& volume, const Plan& plan, const Engine::StartProgress& progress);
  [[nodiscard]] std::pair<float, float> densityRange(const Volume& volume);
  void computeGradientsIn(const WindowBox& box);
  void makeWindows();
  [[nodiscard]] std::vector<gpu::Buffer> windowBuffersOver(const Engine::SharedWindows& shared);
  void makeWindowBuffers();
  template <typename Change>
  Engine::EditResult change(std::int64_t now_ns, const Change& change);
  void keepSamplesFor(double other, std::span<const layout::BrickBounds> bounds);
  void publishBox(const WindowBox& box, std::int64_t now_ns);  // its samples must have been gathered

  double isovalue_;  // of the field that is felt
  std::vector<StageTime> stages_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  BrickGrid grid_;
  std::unique_ptr<BrickPool> pool_;       // the volume, which edits change
  std::unique_ptr<FilterChain> filters_;  // from it to the field that is felt; null: none
  std::unique_ptr<BrickBoundsPass> bounds_;
  std::unique_ptr<SampleStore> store_;
  std::unique_ptr<FilterChain> smoothing_;  // from that field to the one whose gradients are taken; null: the same
  std::unique_ptr<GradientPass> gradient_;  // of a smoothed field without edits both are gone once they were used
  std::unique_ptr<WindowPass> window_;
  std::unique_ptr<Drawing> drawing_;  // the picture that is kept up to date, once show() was called
  bool gradient_all_ = false;
  // Plan::gradientsAsNeeded(): by brick, whether the isosurface needs its gradients; and how many bricks these are.
  // Empty: every gradient that is needed has been computed.
  std::vector<bool> needs_gradient_;
  std::size_t needed_bricks_ = 0;
  int window_edge_ = kWindowEdge;            // the plan's [voxel]
  bool draws_ = false;                       // the plan said so
  bool distance_ = false;                    // the field that is felt is a distance from the isosurface
  std::vector<gpu::Buffer> window_buffers_;  // three, mapped: the exchange's storages, or what is copied there
  bool shares_windows_ = false, copies_windows_ = false;
  std::unique_ptr<WindowExchange> exchange_;
  std::optional<WindowBox> published_;             // where the newest window lies
  unsigned published_slot_ = 0;                    // and in which buffer
  std::unique_ptr<Editor> editor_;                 // once edits are allowed
  std::optional<double> wanted_isovalue_;          // another isovalue, while its samples are gathered
  std::optional<IsovalueChange> isovalue_change_;  // the same, unless every brick has samples
};

}  // namespace palpate
