// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/bench/log_chart.hpp"
#include "apps/bench/loop_bench.hpp"

namespace palpate {

std::string loopIntroduction() {
  return "The real-time loop (hri, n = 5, simulated device, rigid hand at 0.5 m/s over a knot of 128 x 128 x 64 "
         "voxels) while the "
         "engine gathers a\nwindow every 12 ms on its own thread, and `cyclictest` (SCHED_FIFO, same priority, memory "
         "locked, same "
         "clock, no affinity, no power\nmanagement request) in its place, in turns of half a second: loop, cyclictest, "
         "cyclictest, "
         "loop, and so on. Lateness: from the due time to the\nfirst reading of the clock, in whole microseconds, cut "
         "down, on "
         "both sides. A miss: later than a period. On a virtual machine the\ntails are the host's.";
}

std::string loopTable(const BenchResult& result) {
  std::string text = fmt::format("{:<11} {:>7} {:>9}  {:>7} {:>7} {:>7} {:>8} {:>8}  {:>7}  {:>9} {:>9}\n", "", "rate",
                                 "wake-ups", "median", "p90", "p99", "p99.9", "max", "misses", "cost p50", "cost p99");
  text += fmt::format("{:<11} {:>7} {:>9}  {:>7} {:>7} {:>7} {:>8} {:>8}  {:>7}  {:>9} {:>9}\n", "", "Hz", "", "us",
                      "us", "us", "us", "us", "", "us", "us");
  for (const BenchRow& row : result.rows) {
    const std::string part = textOf(row, "part");
    if (part != "loop" && part != "cyclictest") continue;
    text +=
        fmt::format("{:<11} {:>7g} {:>9g}  {:>7g} {:>7g} {:>7g} {:>8g} {:>8g}  {:>7g}", part, figureOf(row, "rate_hz"),
                    figureOf(row, "wakeups"), figureOf(row, "lateness_median_us"), figureOf(row, "lateness_p90_us"),
                    figureOf(row, "lateness_p99_us"), figureOf(row, "lateness_p999_us"),
                    figureOf(row, "lateness_max_us"), figureOf(row, "deadline_misses"));
    if (part == "loop") {
      text +=
          fmt::format("  {:>9.2f} {:>9.2f}", figureOf(row, "tick_cost_median_us"), figureOf(row, "tick_cost_p99_us"));
    }
    text += "\n";
  }
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "loop") continue;
    text += fmt::format(
        "{:g} Hz: windows {:g}, window age p50 {:.1f} ms p99 {:.1f} ms, plane age max {:g} ticks, overrun in {:g} "
        "ticks, "
        "{:g} left out\n",
        figureOf(row, "rate_hz"), figureOf(row, "windows_published"), figureOf(row, "window_age_median_ms"),
        figureOf(row, "window_age_p99_ms"), figureOf(row, "plane_age_max_ticks"), figureOf(row, "overrun_ticks"),
        figureOf(row, "skipped_ticks"));
  }
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "ratio") continue;
    text += fmt::format("{:g} Hz: lateness p99, loop / cyclictest {:.2f}\n", figureOf(row, "rate_hz"),
                        figureOf(row, "loop_over_cyclictest_p99"));
  }
  return text;
}

std::string loopChart(const BenchResult& result) {
  std::vector<ChartPanel> panels;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "histogram") continue;
    const double rate_hz = figureOf(row, "rate_hz");
    const std::string title = fmt::format("{:g} Hz", rate_hz);
    if (panels.empty() || panels.back().title != title) {
      panels.push_back({title, "lateness of a wake-up [us]", "share of wake-ups that are later", {}});
    }
    std::vector<ChartSeries>& series = panels.back().series;
    const std::string side = textOf(row, "side");
    if (series.empty() || series.back().name != side) series.push_back({side, {}});
    series.back().points.push_back({figureOf(row, "lateness_to_us"), figureOf(row, "share_later")});
  }
  return logChartSvg("Lateness of wake-ups, engine busy", panels, ChartMarks::kLine);
}

}  // namespace palpate
