// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_run.hpp: a scene's simulated device led along a path on a rig, in real time or on the simulated
// clock.
#pragma once

#include <functional>

#include "apps/console/progress.hpp"
#include "apps/rig/touch_rig.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

// Blocks for the run's time. Ctrl-C ends it early, in good order. `edits` may be null. `before_first_tick` is called
// once, after the memory for the records of all ticks has been allocated.
[[nodiscard]] LoopResult runServo(const Scene& scene, RigVolume volume, const Path& path, Engine& engine,
                                  RigEdits* edits, Progress& progress, const std::function<void()>& before_first_tick);

}  // namespace palpate
