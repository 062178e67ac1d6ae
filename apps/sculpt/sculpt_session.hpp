// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/sculpt_session.hpp: a volume that is seen, touched and edited by a person: everything behind the window,
// and nothing of the window.
//
// It loads the volume, makes an engine that draws and edits, keeps a journal, and runs the servo by the real clock with
// a device: one that a pointer leads, if it needs a path. Threads: all functions are the window's thread's, unless they
// say otherwise; none waits for the engine or the servo, but for the constructor, start() and close().
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/live/live_volume.hpp"
#include "apps/render/fit_camera.hpp"
#include "apps/rig/live_view.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "engine/field/statistics.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/journal/journal_reader.hpp"
#include "engine/session/edit_session.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/pointer_path.hpp"

namespace palpate {

class RemoteServo;
class ServoProcess;

// A scene whose device is the mouse.
[[nodiscard]] Scene withMouse();

struct SculptRequest {
  std::string volume = {};               // as loadVolume takes it
  std::optional<double> isovalue = {};   // empty: as `palpate touch` chooses it [density]
  std::string gpu = {};                  // part of the Vulkan device's name; empty: the best one
  std::uint64_t gpu_memory_bytes = 0;    // limit for densities and samples; 0: the device's
  std::filesystem::path journal = {};    // folder for the journal; empty: none
  std::filesystem::path recovers = {};   // journal of a session of this volume, whose edits are made again first
  std::size_t undo_bytes = 256U << 20U;  // memory for undo
  // Device, how one that is held is placed, and whether the servo is in a process of its own (`service`), which then
  // opens the device; the rest is not read.
  Scene device = withMouse();
  std::string commit = {};            // of this program, which must be the servo's
  std::shared_ptr<Device> held = {};  // that device, if a person holds it here (openHeldDevice)
  LoopParameters loop = {};  // its ticks are set: the servo runs until close(); of a service's, its rate counts
  RigSettings servo = {};    // its isovalue is set
};

// What a volume is, as loaded.
struct SculptVolume {
  std::string name;
  Vec3i size = Vec3i::Zero();
  Lattice lattice;
  VolumeStatistics statistics;
  SeenExtent object;  // at the first isovalue
};

struct SculptState {
  RigEdits::State edits;
  bool running = false;   // the servo
  bool can_edit = false;  // and the engine, which may outlive a servo in another process
  ForceOff force_off = ForceOff::kNone;
  bool unsaved = false;               // the newest saved file lacks an edit
  std::size_t errands = 0;            // saves and exports that are under way
  std::string drawing_failure;        // LiveView::failure()
  std::string journal_failure;        // why the journal keeps nothing more; empty: it does
  std::vector<std::string> messages;  // since the last look: saves, refusals, failures
};

class SculptSession {
 public:
  // Throws Error as loadVolume, Engine, EditSession and TouchRig do, as readJournal and checkStart do,
  // kBadInput for a device that a window cannot have, and kCancelled on Ctrl-C. Edits that are made again can be
  // undone.
  SculptSession(const SculptRequest& request, Progress& progress);
  ~SculptSession();  // as close(); drops failures
  SculptSession(const SculptSession&) = delete;
  SculptSession& operator=(const SculptSession&) = delete;

  [[nodiscard]] const SculptVolume& volume() const noexcept { return facts_; }
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept;
  [[nodiscard]] const std::string& device() const noexcept { return scene_.device; }
  [[nodiscard]] bool deviceIsHeld() const noexcept { return is_held_; }  // the pointer leads nothing
  // Why the device exerts no force; none before start().
  [[nodiscard]] ForceOff forceOff() const noexcept;
  // What the engine computes, and what it leaves out.
  [[nodiscard]] const std::vector<PlanLine>& plan() const noexcept { return plan_; }

  // The servo and the drawing, until close(). A device that is held is this session's until then, so the session that
  // had it before must have been closed. Before start(), with such a device, nothing may be called that speaks of
  // ticks, settings or state.
  void start();
  [[nodiscard]] bool keepsJournal() const noexcept { return live_->keepsJournal(); }
  // Before start(): whether every edit made until now is on the disk, in the journal. Waits for the disk.
  [[nodiscard]] bool journalHolds() { return live_->journalHolds(); }

  LiveView& view() noexcept { return view_; }
  // Where the pointer leads the tool, unless a person holds the device.
  void aim(const Vec3& hip_W) noexcept;
  // The newest tick; all since the last call are appended to `records`.
  [[nodiscard]] const TickRecord& tick() { return rig_->ticks().latest(); }
  void takeTicks(std::vector<TickRecord>& records) { rig_->ticks().take(records); }

  // A stroke lasts from press() to release(), and is undone as one.
  void press(const ToolBrushSpec& brush);
  void release();
  // That the tool holds now, as text (toolBrushText()); empty: none.
  [[nodiscard]] const std::string& heldBrush() const noexcept { return held_; }
  void undo() { static_cast<void>(live_->edits().undo()); }
  void redo() { static_cast<void>(live_->edits().redo()); }
  void goTo(std::size_t done) { static_cast<void>(live_->edits().goTo(done)); }  // RigEdits::goTo()

  // TouchRig::change() and settings(). A refusal of an isovalue comes as a message.
  void change(const RigSettings& settings) { rig_->change(settings); }
  [[nodiscard]] RigSettings settings() const { return rig_->settings(); }

  // Writes the volume, or its isosurface as a mesh, as the suffix says, with every edit made until now. Goes on in the
  // background; the outcome comes as a message. Throws Error(kBadInput) as checkOutput() does (apps/convert).
  void save(const std::string& file);

  [[nodiscard]] SculptState look();
  // Ends servo and drawing, finishes what save() began, and ends the journal. Deletes the journal if nothing is
  // unsaved. Throws what ended the engine's thread, and Error(kIo) if neither a file nor the journal holds every edit.
  void close();

 private:
  void tell(const std::string& text);
  void makeRemote();
  void makeRig();
  [[nodiscard]] const Device& theDevice() const;

  // Before all that may still have something to tell when it ends.
  std::mutex mutex_;  // guards the next
  std::vector<std::string> messages_;
  SculptVolume facts_;
  std::vector<PlanLine> plan_;
  std::unique_ptr<ServoProcess> process_;       // with device.service
  std::unique_ptr<RemoteServo> remote_, last_;  // its servo, and one before it: to whose memory the engine may write
  std::optional<LiveVolume> live_;
  LiveView view_;
  Scene scene_;
  std::shared_ptr<Device> held_device_;  // not yet placed
  LoopParameters loop_;
  RigSettings first_settings_;
  DensityScale scale_;
  const std::string commit_;
  bool is_held_ = false;
  PointerAimBlock aims_;
  std::optional<PointerAim> aim_;
  std::optional<PointerPath> path_;
  std::unique_ptr<Device> device_;
  bool told_its_end_ = false;
  std::unique_ptr<TouchRig> rig_;
  std::string held_;
  bool started_ = false, closed_ = false;
};

}  // namespace palpate
