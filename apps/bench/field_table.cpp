// SPDX-License-Identifier: Apache-2.0
// How the figures of `palpate bench filters` and `bench gradient` look.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/bench/field_bench.hpp"
#include "apps/bench/log_chart.hpp"

namespace palpate {
namespace {

constexpr int kNameWidth = 73;

bool has(const BenchRow& row, std::string_view key) {
  return std::any_of(row.begin(), row.end(), [&](const auto& cell) { return cell.first == key; });
}

constexpr double kMiBPerMB = 1e6 / (1 << 20);

std::string cell(const BenchRow& row, const char* key, int width, int decimals, double scale = 1) {
  return has(row, key) ? fmt::format(" {:>{}.{}f}", scale * figureOf(row, key), width, decimals)
                       : fmt::format(" {:>{}}", "", width);
}

}  // namespace

std::string fieldIntroduction() {
  return "Every row is one filter or gradient of one volume that lies in memory already (Palpate's in its brick pool, "
         "with pools for results at hand and kernels compiled; the others' as their own images and grids, with a "
         "result made anew for each run, as they make it). All run in turns, in one process but for VTK and SciPy, "
         "which a child runs; medians and quartiles of the wall clock, and processor time of the process. `moved` is "
         "what the passes must move: each reads its field once and writes its result once, samples of a gradient 16 "
         "bytes a voxel, 8 as halves; `of copy` is that over the time, as a share of what a plain copy moves in the "
         "same turns. `Palpate/this` below 1 says that Palpate is the faster one, `by cpu` that it takes less "
         "processor "
         "time, which says more on a busy machine. Who would take more than 12 s of it for one run is left out. SciPy "
         "has one thread, the others "
         "as many as the machine has. VTK and SciPy are measured where they are installed "
         "(`apt-get install python3-scipy python3-vtk9`); Palpate needs neither.";
}

std::string fieldTable(const BenchResult& result) {
  std::string text, last;
  for (const BenchRow& row : result.rows) {
    const std::string part = textOf(row, "part");
    if (part != "run" && part != "left out") continue;
    const std::string head = fmt::format("{}, {}", textOf(row, "job"), textOf(row, "volume"));
    if (head != last) {
      text += fmt::format("{}{}\n", text.empty() ? "" : "\n", head);
      text +=
          fmt::format("{:<{}} {:>9} {:>19} {:>9} {:>5} {:>8} {:>9} {:>7} {:>12} {:>7}\n", "", kNameWidth, "median ms",
                      "quartiles", "cpu ms", "runs", "ns/voxel", "moved MiB", "of copy", "Palpate/this", "by cpu");
      last = head;
    }
    text += fmt::format("{:<{}}", fmt::format("{:<8} {}", textOf(row, "library"), textOf(row, "way")), kNameWidth);
    if (part == "left out") {
      text += fmt::format(" left out: {}\n", textOf(row, "why"));
      continue;
    }
    text += cell(row, "median_ms", 9, 1) + cell(row, "lower_quartile_ms", 9, 1) + cell(row, "upper_quartile_ms", 9, 1) +
            cell(row, "cpu_median_ms", 9, 1) + cell(row, "rounds", 5, 0) + cell(row, "ns_per_voxel", 8, 2) +
            cell(row, "moved_MB", 9, 1, kMiBPerMB) + cell(row, "share_of_copy", 7, 3) +
            cell(row, "palpate_over_this", 12, 2) + cell(row, "palpate_over_this_cpu", 7, 2);
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text;
}

std::string fieldChart(const BenchResult& result, const std::string& title, const std::vector<std::string>& jobs) {
  std::vector<ChartPanel> panels;
  for (const std::string& job : jobs) {
    ChartPanel panel{job, "edge [voxel]", "time [ns a voxel]", {}};
    for (const BenchRow& row : result.rows) {
      if (textOf(row, "part") != "run" || textOf(row, "job") != job || !has(row, "ns_per_voxel")) continue;
      const std::string library = textOf(row, "library");
      const ChartPoint point{std::cbrt(figureOf(row, "voxels")), figureOf(row, "ns_per_voxel"), {}};
      auto series = std::find_if(panel.series.begin(), panel.series.end(),
                                 [&](const ChartSeries& s) { return s.name == library; });
      if (series == panel.series.end()) series = panel.series.insert(series, {library, {}});
      const auto same = std::find_if(series->points.begin(), series->points.end(),
                                     [&](const ChartPoint& p) { return p.x == point.x; });
      if (same == series->points.end()) {
        series->points.push_back(point);
      } else {
        same->y = std::min(same->y, point.y);  // of several ways of a library the fastest
      }
    }
    if (!panel.series.empty()) panels.push_back(std::move(panel));
  }
  return logChartSvg(title, panels, ChartMarks::kPoints);
}

}  // namespace palpate
