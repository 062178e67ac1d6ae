// SPDX-License-Identifier: Apache-2.0
#include "apps/report/html_data.hpp"

#include <charconv>
#include <cmath>
#include <functional>

#include "base/units.hpp"
#include "servo/loop/run_figures.hpp"

namespace palpate {
namespace {

constexpr std::size_t kBuckets = 1500;  // about one for each pixel of a wide screen
constexpr int kDigits = 5;

using Json = nlohmann::ordered_json;
using Column = std::function<double(const TickRecord&)>;

PlotTable tableOf(const std::vector<TickRecord>& records, const std::vector<Column>& columns) {
  PlotTable table;
  table.series.resize(columns.size());
  for (const TickRecord& record : records) {
    table.time_s.push_back(record.time_s);
    for (std::size_t k = 0; k < columns.size(); ++k) table.series[k].push_back(columns[k](record));
  }
  return decimate(table, kBuckets);
}

Json shortened(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  char text[40];
  const auto end = std::to_chars(text, text + sizeof(text), value, std::chars_format::scientific, digits - 1).ptr;
  std::from_chars(text, end, value);
  return value;
}

Json rowsOf(const PlotTable& table) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < table.time_s.size(); ++i) {
    Json row = Json::array({shortened(table.time_s[i], 9)});
    for (const auto& series : table.series) row.push_back(shortened(series[i], kDigits));
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<ReportPlot> makePlots(const TouchRun& run) {
  const auto component = [](int i) { return [i](const TickRecord& r) { return r.force_W[i]; }; };
  std::vector<ReportPlot> plots;
  plots.push_back({"plot-force",
                   "Force [N]",
                   {"x", "y", "z", "magnitude"},
                   tableOf(run.records, {component(0), component(1), component(2), forceOf})});
  plots.push_back({"plot-depth", "Penetration depth [mm]", {"depth"}, tableOf(run.records, {[](const TickRecord& r) {
                                                                                return depthOf(r) *
                                                                                       kMillimetresPerMetre;
                                                                              }})});
  plots.push_back({"plot-energy",
                   "Energy taken from the hand [mJ]",
                   {"energy"},
                   tableOf(run.records, {[](const TickRecord& r) { return r.energy_J * 1e3; }})});
  if (run.scene.simulated_clock) return plots;
  plots.push_back({"plot-cost", "Tick cost [us]", {"cost"}, tableOf(run.records, {[](const TickRecord& r) {
                                                                      return r.tick_cost_ns * 1e-3;
                                                                    }})});
  plots.push_back(
      {"plot-lateness", "Wake-up lateness [us]", {"lateness"}, tableOf(run.records, {[](const TickRecord& r) {
                                                                         return static_cast<double>(r.lateness_ns) *
                                                                                1e-3;
                                                                       }})});
  return plots;
}

Json plotsJson(const std::vector<ReportPlot>& plots, const TouchRun& run) {
  Json data = {{"plots", Json::array()}, {"phases", Json::array()}};
  for (const ReportPlot& plot : plots) {
    data["plots"].push_back(
        {{"id", plot.id}, {"title", plot.title}, {"labels", plot.labels}, {"rows", rowsOf(plot.table)}});
  }
  for (const PathPhase& phase : run.phases) data["phases"].push_back({phase.name, phase.begin_s, phase.end_s});
  return data;
}

}  // namespace palpate
