// SPDX-License-Identifier: Apache-2.0
// apps/view/legend.hpp: title and legend of view.png: what every line, colour and arrow means. Private to apps/view.
#pragma once

#include "apps/report/touch_run.hpp"
#include "apps/view/canvas.hpp"
#include "apps/view/force_arrows.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {

// Two lines at the top: volume, isovalue, largest force and depth; then the run in one sentence.
void drawTitle(Canvas& canvas, const TouchRun& run, const RunFigures& figures, double width, double scale);

// A strip with its top at `y`: samples of the lines with their names, and the colours of the forces.
void drawLegend(Canvas& canvas, const ForceArrows& forces, double y, double scale);

}  // namespace palpate
