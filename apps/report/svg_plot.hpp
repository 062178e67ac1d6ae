// SPDX-License-Identifier: Apache-2.0
// apps/report/svg_plot.hpp: SVG pictures for the report that need no script: histograms, and curves for browsers
// without script.
//
// Colours come from the page's style sheet. Any thread; cost follows the size of the text.
#pragma once

#include <string>
#include <vector>

#include "apps/report/plot_data.hpp"

namespace palpate {

// Bars over a logarithmic time axis; heights are logarithmic too, since one late tick in a million matters. `unit` and
// `things` are for the words of a bar: "1 to 2 us: 9 ticks".
[[nodiscard]] std::string histogramSvg(const LogHistogram& histogram, const std::string& label, const char* unit,
                                       const char* things);

// A polyline of the table's first series over time, with its range written at the axis.
[[nodiscard]] std::string curveSvg(const PlotTable& table, const std::string& label);

}  // namespace palpate
