// SPDX-License-Identifier: Apache-2.0
// engine/service/engine.hpp: runs a plan for one volume on one Vulkan device and publishes windows around the tool.
//
// Thread: one thread at a time. That is first the thread that made it, then the EngineThread, then the first again, for
// the picture. The servo's thread uses exchange() only.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/camera.hpp"
#include "base/measured.hpp"
#include "engine/draw/draw_style.hpp"
#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/field/volume.hpp"
#include "engine/plan/plan.hpp"
#include "engine/service/brick_content.hpp"
#include "servo/window/tool_pose.hpp"
#include "shaders/brick_pool.layout.h"
#include "shaders/draw.layout.h"

namespace palpate {

namespace gpu {
struct GpuInfo;
struct GpuUse;
}  // namespace gpu
class EngineParts;
struct Sample;
struct WindowBlock;
class WindowExchange;

class Engine {
 public:
  // Opens the device, uploads the volume and computes what the plan asks for. Throws Error. `gpu_memory_bytes`: limit
  // for densities and samples (0: the device's memory); beyond it Error(kOutOfMemory) is thrown. `progress` gets the
  // name of the pass that runs and the fraction of it that is done. Only passes that may take long report (filters,
  // smoothing, gradients). It may throw to cancel.
  using StartProgress = std::function<void(const char* pass, double done)>;
  Engine(const Volume& volume, const Plan& plan, double isovalue, const std::string& gpu_name,
         std::uint64_t gpu_memory_bytes = 0, const StartProgress& progress = {});
  ~Engine();

  // Gathers and publishes a window around `focus_W` [m] if there is none yet, or if this point has left the middle of
  // the last one. Otherwise confirms that the last one still holds. Returns whether it published a window. `now_ns`:
  // time on the servo's clock.
  bool publishAround(const Vec3& focus_W, std::int64_t now_ns);
  // As publishAround(), around the point where this tool needs the window (window_focus.hpp).
  bool publishFor(const ToolPose& tool, std::int64_t now_ns);
  // Says that the last window still holds, wherever the tool is; nothing where there is none, or where edits have
  // broken the volume.
  void confirmWindow(std::int64_t now_ns) noexcept;
  // The next of these calls gathers a window wherever the tool is, and computes what gradients it needs, as that of a
  // new engine does. Between two runs.
  void forgetWindow() noexcept;

  // Prepares for edits. Call it once, before the first edit. Kernels of these `kinds` are compiled now, so that not
  // even the first edit waits for the driver's compiler. Throws Error(kBadInput) if the gradients come from a smoothed
  // field and Plan::edits is false, since that field is gone then. Cost: kernels, and reading back the bounds of every
  // brick. `version`: editVersion() until the first edit, for the volume of an engine before this one.
  void allowEdits(const BrushProfile& profile, std::span<const EditKind> kinds = {}, std::uint64_t version = 0);
  struct EditResult {
    std::uint64_t version = 0;  // of the volume; counts edits
    bool published = false;     // a window with the edit was published; false: the edit does not reach it
    std::size_t changed_bricks = 0;
    std::size_t gradient_bricks = 0;
    std::vector<StageTime> stages;  // plan, record, gpu (then its kernels, if timed), publish, settle
  };
  // Applies edit commands in their order (engine/service/editor.hpp). Publishes the box of the last window anew if they
  // reach it. `before` and errors: as in Editor::apply().
  EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns, const BeforeChange& before = {});
  // Replaces whole bricks instead, for undo and replay (Editor::replace).
  EditResult replace(std::span<const BrickContent> bricks, std::int64_t now_ns);
  void timeKernels(bool on) noexcept;  // adds an edit's kernels to EditResult::stages
  // These do what the functions of Editor with the same names do. Call them once edits are allowed.
  [[nodiscard]] bool broken() const noexcept;  // or the device has failed
  [[nodiscard]] const BrushProfile& profile() const noexcept;
  [[nodiscard]] BrickContent content(std::uint32_t brick) const;
  [[nodiscard]] bool isStored(std::uint32_t brick) const noexcept;
  [[nodiscard]] std::vector<std::uint32_t> bricksToChange(std::span<const EditCommand> commands) const;
  [[nodiscard]] std::size_t changedBricks() const noexcept;
  // Copies the bricks that edits changed back into the volume. Returns how many of them differ from what it held. For
  // idle moments.
  std::size_t readBack(Volume& volume);
  // Takes copies of the same bricks, a part at a time (Editor::takeChanged). Call it once edits are allowed.
  [[nodiscard]] std::vector<BrickContent> takeChanged(std::size_t most);
  [[nodiscard]] std::uint64_t editVersion() const noexcept;

  // These change the isovalue [density] while the servo goes on with the present one. Call beginIsovalue(), then
  // gatherIsovalue() until it returns true, let the servo take the new isovalue, then call endIsovalue(). Edits may
  // come in between. Isovalues are rounded to float, as the GPU has them.
  //
  // beginIsovalue() cancels a change that is under way. If it throws, isovalue() is what it was. Error(kBadInput): no
  // density crosses the isovalue; the samples depend on the first isovalue (halves, a distance); the smoothed field was
  // not kept (EngineRequest::other_isovalues). Error(kOutOfMemory). Error(kDevice), also once edits have broken the
  // volume. Cost, as of endIsovalue(): the bounds of every brick are read and tested. If every brick has gradients, the
  // bounds are computed first.
  void beginIsovalue(double isovalue);
  // Computes the gradients of up to `most` bricks that the new isovalue needs in addition. Returns true once all are
  // there. Then a window with them is published, and isovalue() is the new one. Throws Error(kOutOfMemory) if edits
  // have taken the room; then the change is cancelled. Throws Error(kDevice).
  bool gatherIsovalue(std::size_t most, std::int64_t now_ns);
  // Ends a change, or cancels it. isovalue() is `keep` from now on: the new isovalue or the last. What only the other
  // one needed is freed. Throws Error(kDevice).
  void endIsovalue(double keep);

  // The field that is felt, as a volume: the filtered field. Only if the plan filters. Cost: a copy of its bricks.
  [[nodiscard]] Volume filtered(const VolumeFacts& facts);
  [[nodiscard]] bool filters() const noexcept;
  // The isovalue of the field that is felt: the volume's, or 0 if that field is a distance.
  [[nodiscard]] double isovalue() const noexcept;
  // Whether every brick has gradients, not only those around the isosurface.
  [[nodiscard]] bool gradientEverywhere() const noexcept;

  // Bounds of every brick of the field that is felt, by BrickGrid::index. Waits for the GPU; some ns a brick.
  [[nodiscard]] std::vector<layout::BrickBounds> bounds();

  // Draws the isosurface; the plan must ask for it. `between` is called between pieces of work of some 4 ms. If it
  // throws, drawing ends.
  [[nodiscard]] RenderedImage draw(const Camera& camera, const std::function<void()>& between = {},
                                   const DrawStyle& style = {});
  // Keeps a picture up to date beside windows and edits (engine/draw/drawing.hpp), at the isovalue that is felt. Call
  // it again for another camera or style, and when isovalue() has changed.
  void show(const Camera& camera, const DrawStyle& style, DrawOrder order);
  // Submits a piece of the drawing that takes the device about `most_s`. Does not wait for it. Returns true once the
  // picture is whole.
  bool drawPiece(double most_s);
  bool pollPicture();  // whether no such piece is under way; does not wait
  [[nodiscard]] PictureState pictureState() const noexcept;
  void copyPicture(std::vector<layout::PicturePixel>& pixels);  // rows from the top; after show()
  [[nodiscard]] RenderedImage picture();  // a copy of what is there; throws Error(kBadInput) before show()

  [[nodiscard]] WindowExchange& exchange() noexcept;
  // From now on windows are published in memory that a servo in another process reads, and exchange() is the engine's
  // side of that: another object than before. Kernels write there in place, or, where the driver takes no memory of the
  // host, what they wrote is copied. The next call that publishes gathers a window. While nobody reads exchange().
  // Throws Error: kBadInput for windows that are too small, kDevice.
  struct SharedWindows {
    WindowBlock* block = nullptr;  // that neither side has used; it and the samples outlive their use
    std::array<Sample*, 3> samples{};
    std::size_t capacity = 0;         // of each, at least windowCapacity() [sample]
    std::size_t bytes = 0;            // of each, whole pages [byte]
    std::uint64_t first_version = 1;  // of the first window there
  };
  void shareWindows(const SharedWindows& shared);
  [[nodiscard]] std::size_t windowCapacity() const noexcept;  // samples that a window has at most
  [[nodiscard]] bool windowsInPlace() const noexcept;         // nothing is copied
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept;
  [[nodiscard]] const std::vector<StageTime>& stages() const noexcept;
  [[nodiscard]] std::vector<MemoryFigure> memory() const;
  [[nodiscard]] gpu::GpuUse gpuUse() const;  // engine/gpu/gpu_use.hpp
  // The part of memory() that counts against `gpu_memory_bytes`, room to grow included: densities, also filtered and
  // smoothed ones, and samples.
  [[nodiscard]] std::uint64_t budgetedBytes() const noexcept;
  [[nodiscard]] PlanFacts planFacts() const noexcept;

 private:
  std::unique_ptr<EngineParts> parts_;
};

}  // namespace palpate
