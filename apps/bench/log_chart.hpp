// SPDX-License-Identifier: Apache-2.0
// apps/bench/log_chart.hpp: a chart of several panels with two logarithmic axes each, as an SVG file that needs no
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
void addPoint(std::vector<ChartPanel>& panels, const ChartPanel& panel, const std::string& series, ChartPoint point);

// `columns`: panels beside each other; 0: all. The points with rings of a panel are joined by a stepped line, below and
// left of which no choice lies.
[[nodiscard]] std::string logChartSvg(const std::string& title, const std::vector<ChartPanel>& panels, ChartMarks marks,
                                      std::size_t columns = 0);

}  // namespace palpate
