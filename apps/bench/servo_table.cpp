// SPDX-License-Identifier: Apache-2.0
// The tables and the chart of `palpate bench servo`.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/log_chart.hpp"
#include "apps/bench/servo_bench.hpp"
#include "apps/bench/tick_cost.hpp"
#include "base/quantile.hpp"

namespace palpate {
namespace {

constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

struct PaperRow {
  const char* name;          // as the paper prints it
  const char* phantom;       // part of our volume's name
  std::array<double, 4> us;  // by kTableAlgorithms
};
constexpr PaperRow kPaper[] = {
    {"sphere (64x64x64)", "sphere", {kNoTime, 39.00, 47.10, 38.30}},
    {"knot (64x64x64)", "knot", {kNoTime, 42.00, 49.10, 41.20}},
    {"head (128x128x64)", "head", {kNoTime, 48.00, 59.70, 47.40}},
    {"lung (128x128x64)", "lung", {kNoTime, 46.80, 57.60, 46.20}},
};

TableColumns nameColumns() {
  return {{"algorithm", nullptr, {"algorithm", ""}}, {"n_ticks", nullptr, {"n", ""}}};
}

// Ticks of the slide without contact [%]. In all of them the tool is below the surface.
double lostPercent(const BenchRow& row) {
  return 100 * (1 - figureOf(row, "contact_ticks") / std::max(1.0, figureOf(row, "ticks")));
}

Table tickTable() {
  return {{"tick", "accuracy"},
          joined(nameColumns(), shown(costColumns()), shown(errorColumns())),
          [](const BenchRow& row) {
            return fmt::format("{} ({})", textOf(row, "volume"),
                               textOf(row, "part") == "tick" ? "cost and error" : "long path");
          }};
}

// By volume, noise and depth.
Table pressTable() {
  return {{"press"},
          joined(nameColumns(), TableColumns{{"vhip_error_median_voxel", nullptr, {"VHIP", "voxel", 3}},
                                             {"vhip_error_p99_voxel", nullptr, {"p99", "voxel", 3}},
                                             {"force_angle_median_deg", nullptr, {"angle", "deg", 2}},
                                             {"force_angle_p99_deg", nullptr, {"p99", "deg", 2}},
                                             {"force_angle_max_deg", nullptr, {"max", "deg", 1}},
                                             {"force_jump_max_N", nullptr, {"jump", "N", 3}},
                                             {"", lostPercent, {"lost", "%", 1}},
                                             {"fall_throughs", nullptr, {"falls", ""}}}),
          [](const BenchRow& row) {
            const double seeds = figureOf(row, "seeds");
            return fmt::format("{}, noise {:g} voxel, {:g} voxels deep, {:g} {}", textOf(row, "volume"),
                               figureOf(row, "noise_voxel"), figureOf(row, "depth_voxel"), seeds,
                               seeds == 1 ? "seed" : "seeds");
          }};
}

std::string harnessLine(const BenchResult& result) {
  std::string text;
  for (const BenchRow* row : rowsOf(result, "harness")) {
    text += fmt::format(
        "a tick that does nothing {:.1f} ns (in all figures), one without renewal {:.1f} ns, clock {:.0f} ns\n",
        figureOf(*row, "empty_tick_ns"), figureOf(*row, "hri_without_renewal_ns"), figureOf(*row, "clock_ns"));
  }
  return text;
}

// A line for each algorithm and wall: missed + lost at each speed.
std::string strokeTable(const BenchResult& result) {
  LineByLine lines;
  for (const BenchRow* row : rowsOf(result, "strokes")) {
    lines.add(
        fmt::format("  {:<20} {:<14}", textOf(*row, "wall"), textOf(*row, "algorithm")),
        fmt::format("  {:g}+{:g}/{:g}", figureOf(*row, "missed"), figureOf(*row, "lost"), figureOf(*row, "strokes")));
  }
  const std::string text = lines.text();
  return text.empty() ? text : "strokes missed + lost / all at 0.05, 0.1, 0.2, 0.5, 1, 2 m/s\n" + text;
}

// A line for each algorithm and n: force off / angle at each speed.
std::string speedTable(const BenchResult& result) {
  std::string text;
  for (const char* volume : {kBall20mm, kTubeOf8}) {
    std::vector<double> speeds;
    LineByLine lines;
    for (const BenchRow* row : rowsOf(result, "speed", {{"volume", volume}})) {
      const double speed = figureOf(*row, "speed_m_per_s");
      if (speeds.empty() || speeds.back() != speed) speeds.push_back(speed);
      lines.add(
          fmt::format("  {:<14} {:>4g}", textOf(*row, "algorithm"), figureOf(*row, "n_ticks")),
          fmt::format("  {} /{}{:<1}", cellText(*row, "force_off_max", 6, 2),
                      cellText(*row, "force_angle_max_deg", 6, 1), figureOf(*row, "missed_ticks") > 0 ? "!" : ""));
    }
    if (speeds.empty()) continue;
    text += fmt::format(
        "{}, 2 mm deep at {} m/s: "
        "largest force over K depth or its inverse / largest angle [degree]; !: contact lost\n{}",
        volume, fmt::join(speeds, ", "), lines.text());
  }
  return text;
}

// Recovery on and off, for the algorithms that renew planes.
std::string recoveryTable(const BenchResult& result) {
  std::string text;
  for (const BenchRow* row : rowsOf(result, "effects")) {
    if (!textOf(*row, "algorithm").starts_with("hri")) continue;
    text += fmt::format(
        "  {:<14} n={:<3g} {:g} m/s, {:g} voxel deep, {:<8}  jump {} N, on concave regions {} N, mean {} N\n",
        textOf(*row, "algorithm"), figureOf(*row, "n_ticks"), figureOf(*row, "speed_m_per_s"),
        figureOf(*row, "depth_voxel"), textOf(*row, "effects"), cellText(*row, "force_jump_max_N", 6, 3),
        cellText(*row, "force_jump_concave_max_N", 6, 3), cellText(*row, "force_mean_N", 6, 3));
  }
  return text.empty() ? text : "recovery time of 20 ms on the knot of 128x128x64, and none\n" + text;
}

double today_us(const BenchResult& result, const char* phantom, const std::string& algorithm) {
  for (const BenchRow* row :
       rowsOf(result, "tick", {{"algorithm", algorithm}, {"n_ticks", std::int64_t{kTableRenewal}}})) {
    if (textOf(*row, "volume").find(phantom) != std::string::npos) return figureOf(*row, "cost_ns") * 1e-3;
  }
  return kNoTime;
}

std::string timeAndRate(double us, int decimals) {
  if (std::isnan(us)) return fmt::format("| {:>10} {:>10} ", "-", "-");
  return fmt::format("| {:>10.{}f} {:>10.2f} ", us, decimals, 1e3 / us);
}

// Cost against error, each a median over the volumes.
ChartPanel panel(const BenchResult& result, const std::string& title, const char* key, const std::string& label) {
  std::vector<ChartPanel> panels = {{title, "cost of a tick [ns]", label, {}}};
  std::set<std::pair<std::string, double>> drawn;  // by algorithm and n
  for (const BenchRow* first : rowsOf(result, "tick")) {
    const std::string algorithm = textOf(*first, "algorithm");
    const double n = figureOf(*first, "n_ticks");
    if (std::isnan(figureOf(*first, key)) || !drawn.insert({algorithm, n}).second) continue;
    std::vector<double> costs_ns, errors;
    for (const BenchRow* row : rowsOf(result, "tick", {{"algorithm", algorithm}, {"n_ticks", n}})) {
      if (std::isnan(figureOf(*row, key))) continue;
      costs_ns.push_back(figureOf(*row, "cost_ns"));
      errors.push_back(figureOf(*row, key));
    }
    addPoint(panels, panels[0], algorithm, {median(costs_ns), median(errors), fmt::format("n={:g}", n)});
  }
  // An algorithm that keeps no plane has the same errors for any n, bit for bit. It gets one point, at its median cost.
  for (ChartSeries& series : panels[0].series) {
    const auto differs = [&](const ChartPoint& point) { return point.y != series.points.front().y; };
    if (series.points.size() < 2 || std::any_of(series.points.begin(), series.points.end(), differs)) continue;
    std::vector<double> costs_ns;
    for (const ChartPoint& point : series.points) costs_ns.push_back(point.x);
    series.points = {{median(std::move(costs_ns)), series.points.front().y, "any n"}};
  }
  return std::move(panels[0]);
}

}  // namespace

std::string servoTable(const BenchResult& result) {
  return tableText(result, tickTable()) + harnessLine(result) + strokeTable(result) + recoveryTable(result) +
         speedTable(result) + tableText(result, pressTable()) + "\n" + tableOne(result) + "\n" + tableTrial(result);
}

std::string tableOne(const BenchResult& result) {
  std::string text =
      "Table 1: average time of a servo loop [microsecond] and servo rate [kHz]; planes renewed every 5 ticks.\n"
      "\"Intermediate Repr.\" today is hri-paper, the paper's Figure 2 to the letter; hri, the default, mends it.\n";
  std::string titles, units;
  for (const TableAlgorithm& algorithm : kTableAlgorithms) {
    titles += fmt::format("|{:^23}", algorithm.title);
    units += fmt::format("|{:>11}{:>11} ", "time", "rate");
  }
  text += fmt::format("{0:<26}{1}\n{0:<26}{2}\n", "", titles, units);
  for (const PaperRow& row : kPaper) {
    std::string today, then;
    for (std::size_t i = 0; i < row.us.size(); ++i) {
      today += timeAndRate(today_us(result, row.phantom, std::string(kTableAlgorithms[i].name)), 4);
      then += timeAndRate(row.us[i], 2);
    }
    text += fmt::format("{:<26}{}\n{:<26}{}\n", std::string(row.name) + " today", today,
                        std::string(row.name) + " paper", then);
  }
  return text;
}

std::string tableTrial(const BenchResult& result) {
  std::string text, last;
  for (const BenchRow* place : rowsOf(result, "table")) {
    const std::string line = fmt::format("{:<36} {:>5g} {:>5g}", textOf(*place, "volume"),
                                         figureOf(*place, "noise_voxel"), figureOf(*place, "depth_voxel"));
    if (line == last) continue;
    last = line;
    text += line;
    for (const TableAlgorithm& algorithm : kTableAlgorithms) {
      const BenchRows found = rowsOf(result, "table",
                                     {{"volume", textOf(*place, "volume")},
                                      {"noise_voxel", figureOf(*place, "noise_voxel")},
                                      {"depth_voxel", figureOf(*place, "depth_voxel")},
                                      {"algorithm", std::string(algorithm.name)}});
      std::string cell = "-";
      if (!found.empty()) {
        cell = fmt::format("{:>8.4f} {} {:>4.0f}", figureOf(*found[0], "cost_ns") * 1e-3,
                           cellText(*found[0], "force_angle_median_deg", 8, 2), lostPercent(*found[0]));
      }
      text += fmt::format(" |{:>22}", cell);
    }
    text += "\n";
  }
  if (text.empty()) return text;
  std::string head = fmt::format("{:<36} {:>5} {:>5}", "", "noise", "depth");
  for (const TableAlgorithm& algorithm : kTableAlgorithms) head += fmt::format(" |{:^22}", algorithm.title);
  return "Table 1 tried with noise and depth [voxel]: average time of a servo loop [microsecond], "
         "median angle of the force [degree], ticks in which\nthe contact was lost [%]; "
         "planes renewed every 5 ticks. A volume that is nowhere so thick has no line.\n" +
         head + "\n" + text;
}

LogCharts servoCharts(const BenchResult& result) {
  return {{"Cost against error: medians over the volumes",
           {panel(result, "position", "vhip_error_median_voxel", "VHIP error, median [voxel]"),
            panel(result, "direction", "force_angle_median_deg", "angle of the force, median [degree]")},
           ChartMarks::kPoints}};
}

}  // namespace palpate
