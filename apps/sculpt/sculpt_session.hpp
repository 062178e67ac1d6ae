// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/sculpt_session.hpp: a volume that is seen, touched and edited by a person, in this process. As
// sculpt_side.hpp says.
//
// It loads the volume, makes an engine that draws and edits, keeps a journal, and runs the servo by the real clock with
// a device: one that a pointer leads, if it needs a path. Threads: all functions are the window's thread's, unless they
// say otherwise.
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
#include "apps/rig/live_view.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "apps/sculpt/sculpt_side.hpp"
#include "engine/gpu/gpu.hpp"
#include "engine/journal/journal_reader.hpp"
#include "servo/devices/device.hpp"
#include "servo/devices/pointer_path.hpp"

namespace palpate {

class RemoteServo;
class ServoProcess;

// A scene whose device is the mouse.
[[nodiscard]] Scene withMouse();

struct SculptRequest {
  std::string connect = {};              // socket of a service whose volume is shown; empty: of what follows
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

class SculptSession final : public SculptSide {
 public:
  // Throws Error as loadVolume, Engine, EditSession and TouchRig do, as readJournal and checkStart do, kBadInput for a
  // device that a window cannot have, and kCancelled on Ctrl-C. Edits that are made again can be undone.
  SculptSession(const SculptRequest& request, Progress& progress);
  ~SculptSession() override;  // as close(); drops failures
  SculptSession(const SculptSession&) = delete;
  SculptSession& operator=(const SculptSession&) = delete;

  [[nodiscard]] const SeenVolume& volume() const noexcept override { return facts_; }
  [[nodiscard]] const gpu::GpuInfo& gpu() const noexcept;
  [[nodiscard]] const std::string& device() const noexcept override { return scene_.device; }
  [[nodiscard]] bool deviceIsHeld() const noexcept override { return is_held_; }
  [[nodiscard]] ForceOff forceOff() const noexcept override;
  [[nodiscard]] const std::vector<PlanLine>& plan() const noexcept override { return plan_; }

  // A device that is held is this session's from here to close(), so the session that had it before must have been
  // closed. Before start(), with such a device, nothing may be called that speaks of ticks, settings or state.
  void start() override;
  [[nodiscard]] bool keepsJournal() const noexcept override { return live_->keepsJournal(); }
  // Before start(): whether every edit made until now is on the disk, in the journal. Waits for the disk.
  [[nodiscard]] bool journalHolds() { return live_->journalHolds(); }

  LiveView& view() noexcept { return view_; }
  void show(const ViewRequest& wanted) override { view_.show(wanted); }
  [[nodiscard]] const ViewFrame& frame() override { return view_.latest(); }
  void aim(const PointerTarget& target) noexcept override;
  [[nodiscard]] const TickRecord& tick() override { return rig_->ticks().latest(); }
  void takeTicks(std::vector<TickRecord>& records) override { rig_->ticks().take(records); }

  void press(const ToolBrushSpec& brush) override;
  void release() override;
  [[nodiscard]] const std::string& heldBrush() const noexcept override { return held_; }
  void undo() override { static_cast<void>(live_->edits().undo()); }
  void redo() override { static_cast<void>(live_->edits().redo()); }
  void goTo(std::size_t done) override { static_cast<void>(live_->edits().goTo(done)); }

  void change(const RigSettings& settings) override { rig_->change(settings); }
  [[nodiscard]] RigSettings settings() const override { return rig_->settings(); }

  void save(const std::string& file) override;
  [[nodiscard]] SculptState look() override;
  // Ends servo and drawing, finishes what save() began, and ends the journal. Deletes the journal if nothing is
  // unsaved. Throws what ended the engine's thread, and Error(kIo) if neither a file nor the journal holds every edit.
  void close() override;

 private:
  void tell(const std::string& text);
  void makeRemote();
  void makeRig();
  [[nodiscard]] const Device& theDevice() const;

  // Before all that may still have something to tell when it ends.
  std::mutex mutex_;  // guards the next
  std::vector<std::string> messages_;
  SeenVolume facts_;
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
