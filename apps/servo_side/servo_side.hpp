// SPDX-License-Identifier: Apache-2.0
// apps/servo_side/servo_side.hpp: the servo of a rig, in this process or in one of its own.
//
// In order: makeLoop() once, then runSimulated(), or start() and wait(). Threads: the rig's maker makes and runs it;
// give() by any thread, one call at a time; ended(), running() and requestStop() by any; tool() has one reader. Throws
// Error(kDevice) where the other process is gone.
#pragma once

#include <cstdint>
#include <memory>

#include "apps/servo_setup/rig_settings.hpp"
#include "apps/servo_setup/rig_volume.hpp"
#include "servo/devices/device.hpp"
#include "servo/loop/servo_changes.hpp"
#include "servo/loop/servo_loop.hpp"
#include "servo/window/tool_pose.hpp"

namespace palpate {

class ServoSide {
 public:
  virtual ~ServoSide() = default;  // ends a run

  // What is known of the device: only its functions before the loop starts may be called.
  [[nodiscard]] virtual const Device& device() const noexcept = 0;
  [[nodiscard]] virtual ToolPoseMailbox& tool() noexcept = 0;

  // The loop with its first algorithm, which `settings` and `volume` describe. The first pose of the tool is there
  // afterwards. Throws as ServoLoop's constructor and makeAlgorithm() do.
  virtual void makeLoop(const LoopParameters& loop, const RigSettings& settings, const RigVolume& volume,
                        std::unique_ptr<Algorithm> algorithm) = 0;

  // Hands over a change; if it has an algorithm, that of `settings`. Returns its number, as ServoChanges::give().
  virtual std::uint64_t give(ServoChange change, const RigSettings& settings) = 0;
  [[nodiscard]] virtual bool ended(std::uint64_t number) const noexcept = 0;

  [[nodiscard]] virtual LoopResult runSimulated(const ServoLoop::Hook& before_tick) = 0;
  virtual void start() = 0;
  [[nodiscard]] virtual bool running() const noexcept = 0;
  // Its process has ended without a word, or does not answer: nobody reads windows or takes changes any more.
  [[nodiscard]] virtual bool isGone() const noexcept { return false; }
  [[nodiscard]] virtual LoopResult wait() = 0;
  virtual void requestStop() noexcept = 0;
  // Before a run: ticks are told there, which outlives the run. Throws Error(kBadInput) where they cannot be.
  virtual void tellTicksTo(LiveTicks& live) = 0;
};

}  // namespace palpate
