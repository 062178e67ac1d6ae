// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/sculpt_side.hpp: a volume that is seen, touched and edited by a person: everything behind a window, and
// nothing of the window. It is in this process (sculpt_session.hpp), or a service's (served_session.hpp).
//
// Frame W: world [m]. Threads: all functions are the window's thread's; none waits for the engine or the servo, but for
// start() and close().
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/onlook/seen_volume.hpp"
#include "apps/rig/live_view.hpp"
#include "apps/rig/rig_edits.hpp"
#include "apps/servo_setup/rig_settings.hpp"
#include "engine/plan/plan.hpp"
#include "engine/session/tool_brush.hpp"
#include "servo/devices/force_off.hpp"
#include "servo/devices/pointer_path.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct SculptState {
  RigEdits::State edits;
  std::size_t older_steps = 0;  // before those that edits.steps lists
  bool running = false;         // the servo
  std::string missing_servo;    // if it is not: why, and what to do
  bool can_edit = false;        // and the engine, which may outlive a servo in another process
  ForceOff force_off = ForceOff::kNone;
  bool unsaved = false;               // edits would be lost: the newest saved file lacks one, and no service keeps it
  std::size_t errands = 0;            // saves and exports that are under way
  std::string drawing_failure;        // LiveView::failure()
  std::string journal_failure;        // why the journal keeps nothing more; empty: it does
  std::vector<std::string> messages;  // since the last look: saves, refusals, failures
};

class SculptSide {
 public:
  virtual ~SculptSide() = default;

  [[nodiscard]] virtual const SeenVolume& volume() const noexcept = 0;
  [[nodiscard]] virtual const std::string& device() const noexcept = 0;
  [[nodiscard]] virtual bool deviceIsHeld() const noexcept = 0;  // the pointer leads nothing
  // Why the device exerts no force; none before start().
  [[nodiscard]] virtual ForceOff forceOff() const noexcept = 0;
  // What the engine computes, and what it leaves out.
  [[nodiscard]] virtual const std::vector<PlanLine>& plan() const noexcept = 0;
  [[nodiscard]] virtual bool keepsJournal() const noexcept = 0;
  // Another volume can take this one's place in the window.
  [[nodiscard]] virtual bool canBeReplaced() const noexcept { return true; }

  // The servo and the drawing, until close().
  virtual void start() = 0;

  // What is to be seen from now on, and the newest picture, which is valid until the next call.
  virtual void show(const ViewRequest& wanted) = 0;
  [[nodiscard]] virtual const ViewFrame& frame() = 0;
  // Where the pointer leads the tool, unless a person holds the device.
  virtual void aim(const PointerTarget& target) noexcept = 0;
  // The newest tick, valid until the next call; all since the last call are appended to `records`.
  [[nodiscard]] virtual const TickRecord& tick() = 0;
  virtual void takeTicks(std::vector<TickRecord>& records) = 0;

  // A stroke lasts from press() to release(), and is undone as one.
  virtual void press(const ToolBrushSpec& brush) = 0;
  virtual void release() = 0;
  // That the tool holds now, as text (toolBrushText()); empty: none.
  [[nodiscard]] virtual const std::string& heldBrush() const noexcept = 0;
  virtual void undo() = 0;
  virtual void redo() = 0;
  virtual void goTo(std::size_t done) = 0;  // RigEdits::goTo()

  // TouchRig::change() and settings(). A refusal that comes later is a message.
  virtual void change(const RigSettings& settings) = 0;
  [[nodiscard]] virtual RigSettings settings() const = 0;

  // Writes the volume, or its isosurface as a mesh, as the suffix says, with every edit made until now. Goes on in the
  // background; the outcome comes as a message. Throws Error(kBadInput) as checkOutput() does (apps/convert).
  virtual void save(const std::string& file) = 0;

  [[nodiscard]] virtual SculptState look() = 0;
  virtual void close() = 0;
};

}  // namespace palpate
