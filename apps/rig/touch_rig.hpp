// SPDX-License-Identifier: Apache-2.0
// apps/rig/touch_rig.hpp: engine, algorithm, device and servo put together: what palpates a volume, whoever asks for
// it.
//
// The maker gives an engine that is ready, a device and settings. The rig runs the servo and the engine's work beside
// it, by the real or the simulated clock. Settings may be changed while it runs; the servo takes them between two ticks
// without a wait, and the force goes over evenly (servo/loop/servo_loop.hpp). Another isovalue needs other gradients:
// the servo goes over to it once the engine has computed them, a portion between two looks at the tool.
// Threads: one thread makes the rig, runs it and waits for its end; change(), settings(), takeRefusal(), requestStop()
// and running() are any thread's; ticks() is one reader's. `follow` is called by the engine's thread (real clock) or
// the caller's (simulated clock) with every pose of the tool; between start() and wait() the engine is that thread's
// alone.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "apps/rig/isovalue_way.hpp"
#include "apps/rig/rig_edits.hpp"
#include "base/error.hpp"
#include "engine/service/engine_thread.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/contact/effects.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

// What may be changed while the rig runs.
struct RigSettings {
  std::string algorithm = std::string(algorithms().front().name);
  AlgorithmParameters parameters = {};  // the rate is the loop's, the isovalue a float, as the GPU has it
  TransferTables haptization = {};
  EffectParameters effects = {};
  double force_limit_N = SafetyParameters{}.force_limit_N;  // at most the device's own counts [N]

  bool operator==(const RigSettings&) const = default;
};

// What is touched, beside the engine's samples. It stays.
struct RigVolume {
  DensityScale scale = {};
  ContactObjects objects = {};
  std::shared_ptr<const TriangleMesh> isosurface = nullptr;  // of the first isovalue, for an algorithm that needs it
};

// Throws Error(kBadInput) as makeAlgorithm() and makeContactEffects() do.
[[nodiscard]] std::unique_ptr<Algorithm> makeAlgorithm(const RigSettings& settings, const RigVolume& volume);

class TouchRig {
 public:
  using Follow = EngineThread::Follow;

  // Engine and device must outlive the rig. `loop`: its force limit is the settings'. Throws Error: as makeAlgorithm()
  // for the settings, as ServoLoop for the rest; kBadInput for an isovalue or a rate that is not the engine's or
  // loop's, and for an algorithm that reads gradients or a mesh that are not there.
  // `edits`, if given, outlives the rig too; the rig does what it is asked for.
  TouchRig(Engine& engine, Device& device, const LoopParameters& loop, RigVolume volume, RigSettings settings,
           RigEdits* edits = nullptr);
  ~TouchRig();  // stops a run

  // Simulated clock: the whole run in the caller's thread; the engine publishes in step, so that the same inputs give
  // the same records, bit for bit. `before_tick` is called after the engine's work for each tick.
  [[nodiscard]] LoopResult runSimulated(const Follow& follow = {}, const ServoLoop::Hook& before_tick = {});

  // Real clock: start() begins the run, once. wait() ends when it does, and rethrows a failure of the engine's thread,
  // which ends the run too. Throws as ServoLoop::start().
  void start(Follow follow = {});
  [[nodiscard]] bool running() const noexcept { return loop_.running(); }
  [[nodiscard]] LoopResult wait();
  void requestStop() noexcept { loop_.requestStop(); }

  // The new settings, their isovalue rounded to float, are what settings() gives from then on; the servo takes them
  // with its next tick, unless a contact is only remembered just then. Another force limit alone leaves the algorithm
  // as it is. With another isovalue all but the force limit waits for its gradients; of several the newest counts.
  // Makes the algorithm (a mesh's search tree takes a while) in the caller's thread; others wait for that in change()
  // alone. Throws Error(kBadInput) as makeAlgorithm(), for another rate, for an algorithm that reads gradients that are
  // not there, and for one that needs a mesh with another isovalue than the first; then nothing changes.
  void change(const RigSettings& settings);
  [[nodiscard]] RigSettings settings() const;
  // Why the engine has refused an isovalue (Engine::beginIsovalue). Unless another one was asked for since, settings()
  // is what the servo has again. Empty: it has refused none since the last call.
  [[nodiscard]] std::optional<Error> takeRefusal();

  // Before a run: keeps up to `most` ticks for ticks().
  void keepTicks(std::size_t most);
  // Pose, forces, faults, timing of each tick since the last look. Only after keepTicks().
  [[nodiscard]] LiveTicks& ticks() { return *ticks_; }

 private:
  [[nodiscard]] std::unique_ptr<Algorithm> made(const RigSettings& settings) const;
  void look(const ToolPose& pose, std::int64_t now_ns, bool all_at_once);
  void nobodyReads();
  void lookForIsovalue(const ToolPose& pose, std::int64_t now_ns, bool all_at_once);

  Engine& engine_;
  const double rate_hz_;
  const double first_isovalue_;
  const RigVolume volume_;
  RigEdits* const edits_;
  std::mutex callers_;                  // of change(): keeps their order
  mutable std::mutex mutex_;            // guards what follows, and is never held while something is made or computed
  RigSettings settings_;                // what is wanted
  RigSettings given_;                   // what the servo was given: the same but while it waits for an isovalue
  std::unique_ptr<Algorithm> waiting_;  // for that isovalue, as settings_ say
  std::optional<Error> refusal_;
  std::uint64_t taking_ = 0;  // number of the change to the isovalue in use
  IsovalueWay isovalue_way_;
  std::unique_ptr<Algorithm> algorithm_;  // the first one
  ServoChanges changes_;
  ToolPoseMailbox tool_;
  std::optional<LiveTicks> ticks_;
  ServoLoop loop_;
  std::optional<EngineThread> publisher_;
};

}  // namespace palpate
