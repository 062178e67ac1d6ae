// SPDX-License-Identifier: Apache-2.0
// What `palpate bench edit` shows on the terminal, on the page and in the chart.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "apps/bench/edit_bench.hpp"
#include "apps/bench/log_chart.hpp"

namespace palpate {
namespace {

struct Stage {
  const char* key;
  const char* name;
};
constexpr std::array<Stage, 10> kStages = {{{"plan", "plan"},
                                            {"record", "record"},
                                            {"submit_and_wait", "submit, wait"},
                                            {"edit_kernel", "edit kernel"},
                                            {"bounds_kernel", "bounds kernel"},
                                            {"gradient_kernel", "gradient kernel"},
                                            {"window_kernel", "window kernel"},
                                            {"publish", "publish"},
                                            {"read_back", "VDB read-back"},
                                            {"journal_saved", "journal on disk"}}};

std::string nameOf(const BenchRow& row) {
  return fmt::format("{:g}^3{}", figureOf(row, "volume_voxel"), textOf(row, "gradients") == "all" ? " all" : "");
}

}  // namespace

std::string editIntroduction() {
  return "What one edit costs, stage by stage: `plan` finds the bricks and makes room, `record` writes the commands' "
         "list "
         "of work, the four kernels change densities, bounds, gradients and the window, `submit, wait` is what the "
         "driver takes beside them, `publish` hands the window to the servo; that is `to window`. `settle` (storage "
         "given "
         "back) and `VDB read-back` come after it. `journal` is what the journal takes of the engine's thread; `sum` "
         "holds "
         "all of these. `on disk` is the time until the disk has confirmed the record, without the 3 ms in which a "
         "session "
         "gathers records. Medians over edits at random places on the same plane, the volumes taking turns of eight; "
         "`all` has gradients in every brick. `anew` is what it takes to compute that volume's bounds, gradients and "
         "window anew, on the device, `times` how much dearer that is than the edit to its window.";
}

std::string editTable(const BenchResult& result) {
  std::string text = fmt::format(
      "{:<10} {:>6} {:>7}  {:>7} {:>7}  {:>6} {:>6} {:>6}  {:>6} {:>6} {:>6} {:>6}  {:>7} "
      "{:>7} {:>7}  {:>7} {:>7} {:>7}  {:>7} {:>8} {:>6} {:>7}\n",
      "volume", "radius", "bricks", "to win.", "p99", "plan", "record", "wait", "edit", "bounds", "grad.", "window",
      "publish", "settle", "r.back", "journal", "on disk", "sum", "outside", "anew", "times", "GPU");
  text += fmt::format(
      "{:<10} {:>6} {:>7}  {:>7} {:>7}  {:>6} {:>6} {:>6}  {:>6} {:>6} {:>6} {:>6}  {:>7} {:>7} {:>7}  "
      "{:>7} {:>7} {:>7}  {:>7} {:>8} {:>6} {:>7}\n",
      "", "voxel", "", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms", "ms",
      "share", "ms", "dearer", "MiB");
  for (const BenchRow& row : result.rows) {
    const std::string part = textOf(row, "part");
    if (part != "edit") continue;
    const auto ms = [&](const char* stage) { return figureOf(row, std::string(stage) + "_median_ms"); };
    text += fmt::format(
        "{:<10} {:>6g} {:>7g}  {:>7.3f} {:>7.3f}  {:>6.3f} {:>6.3f} {:>6.3f}  {:>6.3f} {:>6.3f} {:>6.3f} "
        "{:>6.3f}  {:>7.3f} {:>7.3f} {:>7.3f}  {:>7.3f} {:>7.2f} {:>7.3f}  {:>7.2f} {:>8.2f} {:>6.0f} {:>7.0f}\n",
        nameOf(row), figureOf(row, "radius_voxel"), figureOf(row, "changed_bricks_median"), ms("to_window"),
        figureOf(row, "to_window_p99_ms"), ms("plan"), ms("record"), ms("submit_and_wait"), ms("edit_kernel"),
        ms("bounds_kernel"), ms("gradient_kernel"), ms("window_kernel"), ms("publish"), ms("settle"), ms("read_back"),
        ms("journal"), ms("journal_saved"), ms("sum"), figureOf(row, "share_outside_kernels"), ms("recompute"),
        figureOf(row, "recompute_over_edit"), figureOf(row, "gpu_memory_MiB"));
  }
  return text;
}

std::string editChart(const BenchResult& result) {
  std::vector<ChartPanel> panels;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "edit") continue;
    const std::string title = nameOf(row) + (textOf(row, "gradients") == "all" ? " gradients" : "");
    auto panel = std::find_if(panels.begin(), panels.end(), [&](const ChartPanel& p) { return p.title == title; });
    if (panel == panels.end()) {
      panel = panels.insert(panels.end(), {title, "brush radius [voxel]", "median time [ms]", {{"to window", {}}}});
      for (const Stage& stage : kStages) panel->series.push_back({stage.name, {}});
    }
    const double radius = figureOf(row, "radius_voxel");
    panel->series[0].points.push_back({radius, figureOf(row, "to_window_median_ms")});
    for (std::size_t n = 0; n < kStages.size(); ++n) {
      panel->series[n + 1].points.push_back({radius, figureOf(row, std::string(kStages[n].key) + "_median_ms")});
    }
  }
  return logChartSvg("One edit, by stage", panels, ChartMarks::kPoints);
}

}  // namespace palpate
