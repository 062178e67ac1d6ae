// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_run.hpp: runs the servo along a path on a prepared engine, in real time or on the simulated clock.
#pragma once

#include <functional>

#include "apps/console/progress.hpp"
#include "apps/scene/scene.hpp"
#include "apps/touch/live_edits.hpp"
#include "engine/service/engine.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/devices/path.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

// Blocks for the run's time. Ctrl-C ends it early, in good order. `edits` may be null. `before_first_tick` is called
// once, after the memory for the records of all ticks has been allocated.
[[nodiscard]] LoopResult runServo(const Scene& scene, AlgorithmSetup setup, const Path& path, Engine& engine,
                                  LiveEdits* edits, Progress& progress, const std::function<void()>& before_first_tick);

}  // namespace palpate
