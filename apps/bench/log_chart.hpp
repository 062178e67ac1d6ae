// SPDX-License-Identifier: Apache-2.0
// apps/bench/log_chart.hpp: a picture of several panels with two logarithmic axes each, as an SVG file that stands on
// its own.
//
// A value that a logarithm does not have (zero, negative, not finite) is left out. Any thread; cost follows the points.
#pragma once

#include <string>
#include <vector>

namespace palpate {

struct ChartPoint {
  double x = 0, y = 0;
  std::string label{};  // written beside the mark, if any
};

struct ChartSeries {
  std::string name;  // the same name has the same colour and mark in every panel
  std::vector<ChartPoint> points;
};

struct ChartPanel {
  std::string title;
  std::string x_label, y_label;  // with the unit
  std::vector<ChartSeries> series;
};

enum class ChartMarks { kPoints, kLine };

// Adds a point to a series of the panel with this title, which are made, and stay in order, as they come.
void addPoint(std::vector<ChartPanel>& panels, const ChartPanel& panel, const std::string& series, ChartPoint point);

[[nodiscard]] std::string logChartSvg(const std::string& title, const std::vector<ChartPanel>& panels,
                                      ChartMarks marks);

}  // namespace palpate
