// SPDX-License-Identifier: Apache-2.0
// engine/service/engine.hpp: runs a plan for one volume on one Vulkan device and publishes windows around the tool.
//
// Thread: one at a time: the one that made it, then the EngineThread, then the first again for the picture. The servo
// touches nothing here but exchange().
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/measured.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/passes/brick_bounds_pass.hpp"
#include "engine/passes/brick_pool.hpp"
#include "engine/passes/gradient_pass.hpp"
#include "engine/passes/isosurface_pass.hpp"
#include "engine/passes/sample_store.hpp"
#include "engine/passes/window_pass.hpp"
#include "engine/plan/plan.hpp"
#include "engine/volume/volume.hpp"
#include "servo/window/tool_pose.hpp"
#include "servo/window/window_exchange.hpp"

namespace palpate {

class Engine {
 public:
  // Opens the device, uploads the volume and computes what the plan asks for. Throws Error.
  Engine(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name);
  ~Engine();

  // Gathers a window around the tool if there is none yet or the tool has left the middle of the last one, and
  // publishes it; otherwise confirms the last one. Returns whether a window was published. `now_ns`: on the servo's
  // clock.
  bool publishAround(const Vec3& focus_W, std::int64_t now_ns);
  // The same, around the place where this tool needs it (window_focus.hpp).
  bool publishFor(const ToolPose& tool, std::int64_t now_ns);

  [[nodiscard]] RenderedImage draw(const Camera& camera);  // the plan must draw

  [[nodiscard]] WindowExchange& exchange() noexcept { return *exchange_; }
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept { return gpu_.info(); }
  [[nodiscard]] const std::vector<StageTime>& stages() const noexcept { return stages_; }
  [[nodiscard]] std::vector<MemoryFigure> memory() const;
  [[nodiscard]] PlanFacts planFacts() const noexcept;

 private:
  template <typename Work>
  void stage(const char* name, Work work);
  void computeGradients(const Plan& plan);
  void makeWindows();

  double isovalue_;
  std::vector<StageTime> stages_;
  gpu::Gpu gpu_;
  gpu::Transfer transfer_;
  std::unique_ptr<BrickPool> pool_;
  std::unique_ptr<BrickBoundsPass> bounds_;
  std::unique_ptr<SampleStore> store_;
  std::unique_ptr<GradientPass> gradient_;
  std::unique_ptr<WindowPass> window_;
  std::unique_ptr<IsosurfacePass> isosurface_;
  std::vector<gpu::Buffer> window_buffers_;  // three, mapped: the exchange's storages
  std::unique_ptr<WindowExchange> exchange_;
  std::optional<WindowBox> published_;  // where the newest window lies
};

}  // namespace palpate
