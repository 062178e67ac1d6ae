// SPDX-License-Identifier: Apache-2.0
// engine/service/engine.hpp: runs a plan for one volume on one Vulkan device and publishes windows around the tool.
//
// Thread: one thread at a time: first the one that made it, then the EngineThread, then the first again for the
// picture. The servo's thread uses exchange() only.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/camera.hpp"
#include "base/measured.hpp"
#include "base/rendered_image.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/field/volume.hpp"
#include "engine/plan/plan.hpp"
#include "engine/service/brick_content.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

namespace gpu {
struct GpuInfo;
}
class EngineParts;
class WindowExchange;

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
  // reach it. `before`: as Editor::apply has it. Throws as that does.
  EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns, const BeforeChange& before = {});
  // The same with whole bricks, for undo and replay (Editor::replace).
  EditResult replace(std::span<const BrickContent> bricks, std::int64_t now_ns);
  void timeKernels(bool on) noexcept;  // of edits, among EditResult::stages
  // Of the edits, once they are allowed; as Editor's of the same name.
  [[nodiscard]] bool broken() const noexcept;
  [[nodiscard]] const BrushProfile& profile() const noexcept;
  [[nodiscard]] BrickContent content(std::uint32_t brick) const;
  [[nodiscard]] bool isStored(std::uint32_t brick) const noexcept;
  [[nodiscard]] std::vector<std::uint32_t> bricksToChange(std::span<const EditCommand> commands) const;
  [[nodiscard]] std::size_t changedBricks() const noexcept;
  // Brings the bricks that edits changed back into the volume; returns how many of its bricks hold something else now.
  // For idle moments.
  std::size_t readBack(Volume& volume);
  // The same as copies, a part at a time (Editor::takeChanged); once edits are allowed.
  [[nodiscard]] std::vector<BrickContent> takeChanged(std::size_t most);
  [[nodiscard]] std::uint64_t editVersion() const noexcept;

  // Another isovalue [density], while the servo goes on with the present one: begin, gather until it returns true, let
  // the servo go over, end. Edits may come in between. Isovalues are rounded to float, as the GPU has them.
  // beginIsovalue() gives up a change that is under way. Throws Error, and then isovalue() is what it was: kBadInput
  // for an isovalue that no density crosses, for samples that hang on the isovalue (halves, a distance), and for a
  // smoothed field that was not kept (EngineRequest::other_isovalues); kOutOfMemory; kDevice, also once edits have
  // broken the volume. Cost, as of endIsovalue(): the bounds of every brick are read and looked at; where every brick
  // has gradients, they are computed.
  void beginIsovalue(double isovalue);
  // Computes gradients of up to `most` bricks that it needs besides. Returns true once all are there: then a window
  // with them is published and isovalue() is the new one. Throws Error: kOutOfMemory if edits have taken the room, and
  // then the change is given up; kDevice.
  bool gatherIsovalue(std::size_t most, std::int64_t now_ns);
  // Ends a change, or gives it up: `keep` is isovalue() from now on, the new one or the last, and what only the other
  // needed is freed. Throws Error(kDevice).
  void endIsovalue(double keep);

  // The field that is felt: the filtered one, as a volume; only where the plan filters. Cost: a copy of its bricks.
  [[nodiscard]] Volume filtered(const VolumeFacts& facts);
  [[nodiscard]] bool filters() const noexcept;
  // Of the field that is felt: the volume's, or 0 where that is a distance.
  [[nodiscard]] double isovalue() const noexcept;
  // Gradients are everywhere, not only around the isosurface.
  [[nodiscard]] bool gradientEverywhere() const noexcept;

  // The plan must draw. `between`: called between bands of rows; what it throws ends the drawing.
  [[nodiscard]] RenderedImage draw(const Camera& camera, const std::function<void()>& between = {});

  [[nodiscard]] WindowExchange& exchange() noexcept;
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept;
  [[nodiscard]] const std::vector<StageTime>& stages() const noexcept;
  [[nodiscard]] std::vector<MemoryFigure> memory() const;
  // Of that, what counts against `gpu_memory_bytes`: densities, filtered and smoothed ones too, and samples, with room
  // to grow.
  [[nodiscard]] std::uint64_t budgetedBytes() const noexcept;
  [[nodiscard]] PlanFacts planFacts() const noexcept;

 private:
  std::unique_ptr<EngineParts> parts_;
};

}  // namespace palpate
