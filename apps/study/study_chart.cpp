// SPDX-License-Identifier: Apache-2.0
#include "apps/study/study_chart.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/study/study_analysis.hpp"

namespace palpate {
namespace {

void addLine(ChartPanel& panel, const PlotLine& line, const PlottedRows& plotted) {
  constexpr int kSteps = 16;
  const auto [low, high] = std::minmax_element(plotted.at.begin(), plotted.at.end(),
                                               [](const auto& a, const auto& b) { return a.cost < b.cost; });
  ChartSeries series{line.name, {}, SeriesLook::kDashed};
  for (int i = 0; i <= kSteps; ++i) {
    const double x = low->cost * std::pow(high->cost / low->cost, static_cast<double>(i) / kSteps);
    series.points.push_back({x, line.at(x)});
  }
  panel.series.push_back(std::move(series));
}

ChartPanel panelOf(const StudyPlot& plot, const PlottedRows& plotted) {
  std::vector<ChartPanel> panels;
  const ChartPanel empty{plot.title, plot.x_label, plot.y_label, {}};
  for (std::size_t i = 0; i < plotted.rows.size(); ++i) {
    const BenchRow& row = *plotted.rows[i];
    const bool on_front = std::find(plotted.front.begin(), plotted.front.end(), i) != plotted.front.end();
    const bool is_default = !plot.standard.empty() && hasAll(row, plot.standard);
    std::string label = on_front || is_default ? wordsOf(row, plot.labels) : "";
    if (is_default) label += label.empty() ? "default" : " (default)";
    addPoint(panels, empty, wordsOf(row, plot.series), {plotted.at[i].cost, plotted.at[i].error, label, on_front});
  }
  for (ChartSeries& series : panels.front().series) {
    if (plot.front) series.look = SeriesLook::kMarksAlone;
    std::ranges::sort(series.points, {}, &ChartPoint::x);
  }
  for (const PlotLine& line : plot.lines) addLine(panels.front(), line, plotted);
  return panels.front();
}

}  // namespace

std::vector<ChartPanel> panelsOf(const BenchResult& result, const Study& study, bool quick) {
  std::vector<ChartPanel> panels;
  for (const StudyPlot& plot : study.plots(quick)) {
    const PlottedRows plotted = plottedRows(result, study, plot);
    if (!plotted.rows.empty()) panels.push_back(panelOf(plot, plotted));
  }
  return panels;
}

LogCharts studyCharts(const BenchResult& result, const Study& study, bool quick) {
  std::vector<ChartPanel> panels = panelsOf(result, study, quick);
  if (panels.empty()) return {};
  return {{study.title, std::move(panels), ChartMarks::kPoints, kPlotsAcross}};
}

LogCharts errorCharts(const BenchResult& result) {
  LogCharts charts;
  for (const Study& study : studies())
    std::ranges::move(studyCharts(result, study, isQuick(result)), std::back_inserter(charts));
  return charts;
}

}  // namespace palpate
