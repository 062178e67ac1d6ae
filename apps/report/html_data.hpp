// SPDX-License-Identifier: Apache-2.0
// apps/report/html_data.hpp: the plots of report.html as data.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/report/plot_data.hpp"
#include "apps/report/touch_run.hpp"

namespace palpate {

struct ReportPlot {
  std::string id;                   // of the HTML element that it is drawn into
  std::string title;                // with the unit
  std::vector<std::string> labels;  // of the series; the last one is drawn boldest
  PlotTable table;                  // decimated
};

// The plots of force, depth and energy and, unless the clock was simulated, of tick cost and lateness. Any thread; some
// passes over the records.
[[nodiscard]] std::vector<ReportPlot> makePlots(const TouchRun& run);

// {"plots": [{id, title, labels, rows: [[time, ...], ...]}], "phases": [...]}: numbers to five digits, NaN as null.
[[nodiscard]] nlohmann::ordered_json plotsJson(const std::vector<ReportPlot>& plots, const TouchRun& run);

}  // namespace palpate
