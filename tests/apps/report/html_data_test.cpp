// SPDX-License-Identifier: Apache-2.0
// The plots of one tick, to the letter.
#include "apps/report/html_data.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace html_data_test {

using Json = nlohmann::ordered_json;

TouchRun oneTick() {
  TouchRun run;
  TickRecord r;
  r.time_s = 0.1234567891234;
  r.in_contact = true;
  r.force_W[0] = 1;
  r.force_W[1] = -2;
  r.force_W[2] = 2;
  r.depth_m = 1.23456e-3;
  r.energy_J = 0.0025;
  r.tick_cost_ns = 4321;
  r.lateness_ns = 98765;
  run.records = {r};
  run.phases = {{"press", 1, 2.5}};
  return run;
}

// Times to nine digits, figures to five, in the units of the titles.
TEST(HtmlData, HasEveryPlotInItsUnit) {
  const TouchRun run = oneTick();
  EXPECT_EQ(plotsJson(makePlots(run), run), Json::parse(R"({"plots": [
    {"id": "plot-force", "title": "Force [N]", "labels": ["x", "y", "z", "magnitude"],
     "rows": [[0.123456789, 1, -2, 2, 3]]},
    {"id": "plot-depth", "title": "Penetration depth [mm]", "labels": ["depth"], "rows": [[0.123456789, 1.2346]]},
    {"id": "plot-energy", "title": "Energy taken from the hand [mJ]", "labels": ["energy"],
     "rows": [[0.123456789, 2.5]]},
    {"id": "plot-cost", "title": "Tick cost [us]", "labels": ["cost"], "rows": [[0.123456789, 4.321]]},
    {"id": "plot-lateness", "title": "Wake-up lateness [us]", "labels": ["lateness"], "rows": [[0.123456789, 98.765]]}],
    "phases": [["press", 1, 2.5]]})"));
}

TEST(HtmlData, WhatIsUnknownIsNullAndASimulatedClockHasNoTimes) {
  TouchRun run = oneTick();
  run.scene.simulated_clock = true;
  run.records[0].depth_m = std::nan("");
  const std::vector<ReportPlot> plots = makePlots(run);
  ASSERT_EQ(plots.size(), 3U);
  EXPECT_TRUE(plotsJson(plots, run)["plots"][1]["rows"][0][1].is_null());
}

}  // namespace html_data_test
}  // namespace palpate
