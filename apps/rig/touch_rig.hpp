// SPDX-License-Identifier: Apache-2.0
// apps/rig/touch_rig.hpp: puts engine, algorithm, device and servo together, and palpates a volume with them.
//
// The maker provides an engine that is ready, a device and settings. The rig runs the servo and, beside it, the
// engine's work, by the real or the simulated clock. Settings may be changed during the run. The servo takes them
// between two ticks without waiting, and the force goes over evenly (servo/loop/servo_loop.hpp). Another isovalue needs
// other gradients. The engine computes them in portions, between looks at the tool; then the servo goes over to it.
//
// Threads: one thread makes the rig, runs it and waits for its end. change(), settings(), takeRefusal(), requestStop()
// and running() may be called from any thread, ticks() from one reader. `follow` is called with every pose of the tool,
// by the engine's thread (real clock) or the caller's (simulated clock). Between start() and wait() only the engine's
// thread may use the engine.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/rig/isovalue_transition.hpp"
#include "apps/rig/live_view.hpp"
#include "apps/rig/rig_edits.hpp"
#include "apps/servo_setup/rig_settings.hpp"
#include "apps/servo_setup/rig_volume.hpp"
#include "apps/servo_side/servo_side.hpp"
#include "base/error.hpp"
#include "engine/service/engine_thread.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

[[nodiscard]] DensityScale densityScaleOf(const Volume& volume, double isovalue);

// Throws Error(kBadInput) for an algorithm that reads gradients where none are.
void checkHasGradients(const std::string& algorithm, bool gradient_everywhere);

class TouchRig {
 public:
  using Follow = std::function<void(const ToolPose& pose, std::int64_t now_ns)>;

  // Engine, device and `edits` (if given) must outlive the rig. The force limit of `loop` is replaced by that of the
  // settings. The rig does the requests that come to `edits`. Throws Error: as makeAlgorithm() and ServoLoop do;
  // kBadInput if the settings' isovalue is not the engine's or their rate not the loop's, and for an algorithm that
  // reads gradients or a mesh that are not there.
  TouchRig(Engine& engine, Device& device, const LoopParameters& loop, RigVolume volume, RigSettings settings,
           RigEdits* edits = nullptr);
  // The same with a servo that may be in another process; it outlives the rig, and reads the engine's windows.
  TouchRig(Engine& engine, ServoSide& servo, const LoopParameters& loop, RigVolume volume, RigSettings settings,
           RigEdits* edits = nullptr);
  ~TouchRig();  // stops a run

  // Simulated clock: does the whole run in the caller's thread. The engine publishes in step, so the same inputs give
  // the same records, bit for bit. `before_tick` is called for each tick, after the engine's work.
  [[nodiscard]] LoopResult runSimulated(const Follow& follow = {}, const ServoLoop::Hook& before_tick = {});

  // Real clock: start() begins the run; only once. wait() returns when the run ends. A failure of the engine's thread
  // ends the run, and wait() rethrows it; else it throws that of a servo in another process, whose end leaves the
  // engine at work until then. start() throws as ServoLoop::start() does.
  // `before`: called instead of `follow` until the servo's first tick, which may never come. Edits are made then, too.
  void start(Follow follow = {}, std::function<void(std::int64_t now_ns)> before = {});
  [[nodiscard]] bool running() const noexcept { return servo_.running(); }
  // The engine's thread does its work, whatever has become of the servo. By who made the rig.
  [[nodiscard]] bool engineWorks() const noexcept { return publisher_ && !publisher_->failed(); }
  [[nodiscard]] bool engineFailed() const noexcept { return engine_failed_; }  // after wait(), which threw its failure
  [[nodiscard]] LoopResult wait();
  void requestStop() noexcept { servo_.requestStop(); }

  // Changes the settings; their isovalue is rounded to float. settings() returns them from then on. The servo takes
  // them with its next tick, unless it only remembers its contact in that tick. If only the force limit differs, the
  // algorithm stays. With another isovalue, everything but the force limit waits for the gradients; if several are
  // requested meanwhile, the newest counts.
  //
  // The new algorithm is made in the caller's thread, which may take a while (the search tree of a mesh). Meanwhile
  // only other calls of change() wait. Throws Error(kBadInput), and changes nothing: as makeAlgorithm() does; for
  // another rate; for an algorithm that reads gradients that are not there; for one that needs a mesh, with another
  // isovalue than the first.
  void change(const RigSettings& settings);
  [[nodiscard]] RigSettings settings() const;
  // The servo has been given all that change() asked for: no isovalue waits for its gradients.
  [[nodiscard]] bool isSettled() const;
  // Why the engine refused an isovalue since the last call (Engine::beginIsovalue); empty if it did not. After a
  // refusal settings() returns the servo's settings again, unless another isovalue was requested since.
  [[nodiscard]] std::optional<Error> takeRefusal();

  // What of these settings the device cannot render, one line each (boundWarnings()).
  [[nodiscard]] std::vector<std::string> warnings(const RigSettings& settings) const;

  // Before a run by the real clock: the engine's thread draws for this view, which must outlive the rig.
  void drawFor(LiveView& view) noexcept { view_ = &view; }

  // Before a run: keeps up to `most` ticks for ticks().
  void keepTicks(std::size_t most);
  // Pose, forces, faults and timing of each tick since the reader's last look. Only after keepTicks().
  [[nodiscard]] LiveTicks& ticks() { return *ticks_; }

 private:
  [[nodiscard]] std::unique_ptr<Algorithm> algorithmFor(const RigSettings& settings) const;
  [[nodiscard]] bool mayShake(const RigSettings& settings) const;
  void look(const ToolPose& pose, std::int64_t now_ns, bool all_at_once);
  void freeUnusedSamples();
  void lookForIsovalue(const ToolPose& pose, std::int64_t now_ns, bool all_at_once);

  TouchRig(Engine& engine, std::unique_ptr<ServoSide> own, const LoopParameters& loop, RigVolume volume,
           RigSettings settings, RigEdits* edits);

  Engine& engine_;
  std::optional<LiveTicks> ticks_;        // the servo's thread adds to them, so they outlive it
  std::unique_ptr<ServoSide> own_servo_;  // null: the maker's
  ServoSide& servo_;
  const LoopParameters loop_settings_;
  const double rate_hz_;
  const double first_isovalue_;
  const RigVolume volume_;
  RigEdits* const edits_;
  LiveView* view_ = nullptr;
  std::mutex callers_;                  // keeps the calls of change() in order
  mutable std::mutex mutex_;            // guards what follows; never held while something is made or computed
  RigSettings settings_;                // the settings that were requested
  RigSettings given_;                   // the settings that the servo was given; they differ while an isovalue waits
  std::unique_ptr<Algorithm> waiting_;  // made for settings_; waits for the isovalue's gradients
  std::optional<Error> refusal_;
  std::uint64_t taking_ = 0;  // number of the change to the isovalue in use
  IsovalueTransition isovalue_transition_;
  std::optional<EngineThread> publisher_;
  bool engine_failed_ = false;
};

}  // namespace palpate
