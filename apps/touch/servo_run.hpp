// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_run.hpp: the run of the servo: checks its length beforehand, and lets a device touch the volume on a
// rig, by the real or the simulated clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/device.hpp"

namespace palpate {

// Memory for the records of a scene's run [byte]. It counts them twice, since making the report needs a copy. Any
// thread.
[[nodiscard]] double recordBytes(const Scene& scene);

// Throws Error, which names the flags or the path's file: kBadInput for a run without a tick, kOutOfMemory if the
// records do not fit into `available_bytes`.
void checkRunLength(const Scene& scene, std::uint64_t available_bytes);

struct ServoRun {
  LoopResult loop;
  double most_damping_Ns_per_m = std::numeric_limits<double>::infinity();  // renderableDamping()
  // Simulated clock: mean time that a tick took this machine, with the engine's work before it (windows, edits). The
  // first tick, whose window may wait for the driver's compiler, does not count [us].
  std::optional<double> loop_us_a_tick = {};
  std::vector<std::string> threads = {};  // names of those that the process had while the servo ran
};

// Blocks for the run's time. Ctrl-C ends it early, in good order. `edits` may be null. `before_first_tick` is called
// once, after the memory for the records of all ticks has been allocated, with what the device cannot render
// (apps/servo_setup/contact_bounds.hpp).
using BeforeFirstTick = std::function<void(const std::vector<std::string>&)>;
[[nodiscard]] ServoRun runServo(const Scene& scene, RigVolume volume, Device& device, Engine& engine, RigEdits* edits,
                                Progress& progress, const BeforeFirstTick& before_first_tick);
// The same with a servo that may be in another process, and reads the engine's windows.
[[nodiscard]] ServoRun runServo(const Scene& scene, RigVolume volume, ServoSide& servo, Engine& engine, RigEdits* edits,
                                Progress& progress, const BeforeFirstTick& before_first_tick);

}  // namespace palpate
