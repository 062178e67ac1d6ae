// SPDX-License-Identifier: Apache-2.0
// apps/touch/servo_run.hpp: runs the servo along a path on a prepared engine, in real time or on the simulated clock.
#pragma once

#include "apps/console/progress.hpp"
#include "apps/touch/live_edits.hpp"
#include "engine/plan/scene.hpp"
#include "engine/service/engine.hpp"
#include "servo/algorithms/registry.hpp"
#include "servo/devices/path.hpp"
#include "servo/loop/servo_loop.hpp"

namespace palpate {

// Blocks for the run's time. Ctrl-C ends it early, in order. `edits`: may be null.
[[nodiscard]] LoopResult runServo(const Scene& scene, AlgorithmSetup setup, const Path& path, Engine& engine,
                                  LiveEdits* edits, Progress& progress);

}  // namespace palpate
