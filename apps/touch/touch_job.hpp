// SPDX-License-Identifier: Apache-2.0
// apps/touch/touch_job.hpp: `palpate touch`: loads a volume, plans, computes on Vulkan, runs the servo along a path,
// reports.
#pragma once

#include <string>

#include "apps/console/progress.hpp"
#include "apps/report/touch_run.hpp"
#include "apps/scene/scene.hpp"

namespace palpate {

// Runs the scene and writes trace.csv, summary.json, report.html and view.png into its output folder; each is there
// whole or not at all. `command`: the line that repeats the run. Throws Error; then no result is left behind. Ctrl-C
// while the servo runs or the picture is drawn throws nothing: the results up to then are written, without a picture,
// and TouchRun::ended_early says so.
TouchRun runTouchJob(const Scene& scene, const std::string& command, const std::string& commit, Progress& progress);

}  // namespace palpate
