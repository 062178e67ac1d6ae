// SPDX-License-Identifier: Apache-2.0
// apps/bench/log_chart.hpp: charts of several panels with two logarithmic axes each, as an SVG file that needs no
// other file. It prints well: up to twelve series have marks that can be told apart without colours.
//
// Points with a zero, negative or non-finite value are left out. Any thread; cost: linear in the number of points.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

struct ChartPoint {
  double x = 0, y = 0;
  std::string label{};    // written beside the mark; empty: none
  bool on_front = false;  // of Pareto: the mark has a ring
};

// How a series is drawn: as the chart says, its marks without a line, or as a dashed line of a formula.
enum class SeriesLook { kAsChart, kMarksAlone, kDashed };

struct ChartSeries {
  std::string name;  // the same name has the same colour and mark in every panel
  std::vector<ChartPoint> points;
  SeriesLook look = SeriesLook::kAsChart;
};

struct ChartPanel {
  std::string title;
  std::string x_label, y_label;  // with the unit
  std::vector<ChartSeries> series;
};

enum class ChartMarks { kPoints, kLine };

// Adds a point to the series of this name in the panel with the title of `panel`. Panel and series are added to the
// end if they are not there yet.
void addPoint(std::vector<ChartPanel>& panels, ChartPanel panel, const std::string& series, ChartPoint point);

struct LogChart {
  std::string title;
  std::vector<ChartPanel> panels;
  ChartMarks marks = ChartMarks::kPoints;
  std::size_t columns = 0;  // panels beside each other; 0: all
};
using LogCharts = std::vector<LogChart>;

// The panels of these titles alone, in their order. Throws Error(kBadInput) on a title that no panel has.
[[nodiscard]] LogCharts onlyPanels(LogCharts charts, const std::vector<std::string>& titles);

// The charts one below the other. The points with rings of a panel are joined by a stepped line, below and left of
// which no choice lies. Each chart has a legend of its own.
[[nodiscard]] std::string logChartSvg(const LogCharts& charts);

}  // namespace palpate
