// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/bench/servo_bench.hpp"

namespace palpate {
namespace {

// A dash for what an algorithm does not have.
std::string cell(const BenchRow& row, const char* key, int width, int decimals) {
  const double value = figureOf(row, key);
  return std::isnan(value) ? fmt::format("{:>{}}", "-", width) : fmt::format("{:>{}.{}f}", value, width, decimals);
}

std::string errorCells(const BenchRow& row) {
  return fmt::format("{} {}  {} {}  {} {}  {}", cell(row, "vhip_error_median_voxel", 7, 4),
                     cell(row, "vhip_error_p99_voxel", 7, 4), cell(row, "force_error_median_percent", 7, 3),
                     cell(row, "force_error_p99_percent", 7, 3), cell(row, "force_angle_median_deg", 7, 2),
                     cell(row, "force_angle_p99_deg", 7, 2), cell(row, "force_jump_max_N", 7, 3));
}

std::string tickLine(const BenchRow& row) {
  return fmt::format("  {:<14} {:>4g}  {} {} {} {}  {}  {:>6g}\n", textOf(row, "algorithm"), figureOf(row, "n_ticks"),
                     cell(row, "cost_ns", 7, 1), cell(row, "tick_p99_ns", 7, 0), cell(row, "tick_p999_ns", 7, 0),
                     cell(row, "tick_max_ns", 7, 0), errorCells(row), figureOf(row, "fall_throughs"));
}

std::string accuracyLine(const BenchRow& row) {
  return fmt::format("  {:<14} {:>4g}  {:>31}  {}  {:>6g}\n", textOf(row, "algorithm"), figureOf(row, "n_ticks"), "",
                     errorCells(row), figureOf(row, "fall_throughs"));
}

constexpr const char* kHead =
    "  {:<14} {:>4}  {:^31}  {:^15}  {:^15}  {:^15}  {:>7}  {:>6}\n"
    "  {:<14} {:>4}  {:>7} {:>7} {:>7} {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>7}  {:>6}\n";

std::string head() {
  return fmt::format(kHead, "", "", "cost of a tick [ns]", "VHIP [voxel]", "force [%]", "angle [deg]", "jump", "falls",
                     "algorithm", "n", "mean", "p99", "p99.9", "max", "median", "p99", "median", "p99", "median", "p99",
                     "[N]", "");
}

// One line an algorithm and wall: missed + lost at each speed.
std::string strokeTable(const BenchResult& result) {
  std::string text, last;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "strokes") continue;
    const std::string line = fmt::format("{:<20} {:<14}", textOf(row, "wall"), textOf(row, "algorithm"));
    if (line != last) text += (text.empty() ? "" : "\n") + ("  " + line);
    last = line;
    text += fmt::format("  {:g}+{:g}/{:g}", figureOf(row, "missed"), figureOf(row, "lost"), figureOf(row, "strokes"));
  }
  return text.empty() ? text : "strokes missed + lost / all at 0.05, 0.1, 0.2, 0.5, 1, 2 m/s\n" + text + "\n";
}

// Of the slide's ticks, in all of which the tool is below the surface.
double lostPercent(const BenchRow& row) {
  return 100 * (1 - figureOf(row, "contact_ticks") / std::max(1.0, figureOf(row, "ticks")));
}

// By volume, noise and depth.
std::string pressTable(const BenchResult& result) {
  std::string text, last;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "press") continue;
    const std::string title = fmt::format("{}, noise {:g} voxel, {:g} voxels deep, {:g} {}", textOf(row, "volume"),
                                          figureOf(row, "noise_voxel"), figureOf(row, "depth_voxel"),
                                          figureOf(row, "seeds"), figureOf(row, "seeds") == 1 ? "seed" : "seeds");
    if (title != last) {
      text += fmt::format("{}\n  {:<14} {:>4}  {:>15}  {:>23}  {:>7}  {:>6} {:>6}\n", title, "algorithm", "n",
                          "VHIP med, p99", "angle med, p99, max", "jump", "lost %", "falls");
    }
    last = title;
    text += fmt::format("  {:<14} {:>4g}  {} {}  {} {} {}  {}  {:>6.1f} {:>6g}\n", textOf(row, "algorithm"),
                        figureOf(row, "n_ticks"), cell(row, "vhip_error_median_voxel", 7, 3),
                        cell(row, "vhip_error_p99_voxel", 7, 3), cell(row, "force_angle_median_deg", 7, 2),
                        cell(row, "force_angle_p99_deg", 7, 2), cell(row, "force_angle_max_deg", 7, 1),
                        cell(row, "force_jump_max_N", 7, 3), lostPercent(row), figureOf(row, "fall_throughs"));
  }
  return text;
}

// Volume by volume, one line an algorithm and n: force off / angle at each speed.
std::string speedTable(const BenchResult& result) {
  std::string text, last_volume;
  std::vector<double> speeds;
  std::vector<std::pair<std::string, std::string>> lines;  // in the order of the first speed
  const auto flush = [&] {
    if (lines.empty()) return;
    text += fmt::format(
        "{}, 2 mm deep at {} m/s: largest force over K depth or its inverse / largest angle [degree]; !: contact "
        "lost\n",
        last_volume, fmt::join(speeds, ", "));
    for (const auto& [name, figures] : lines) text += "  " + name + figures + "\n";
    lines.clear();
    speeds.clear();
  };
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "speed") continue;
    if (textOf(row, "volume") != last_volume) flush();
    last_volume = textOf(row, "volume");
    const double speed = figureOf(row, "speed_m_per_s");
    if (speeds.empty() || speeds.back() != speed) speeds.push_back(speed);
    const std::string name = fmt::format("{:<14} {:>4g}", textOf(row, "algorithm"), figureOf(row, "n_ticks"));
    auto at = std::find_if(lines.begin(), lines.end(), [&](const auto& line) { return line.first == name; });
    if (at == lines.end()) at = lines.insert(lines.end(), {name, ""});
    at->second += fmt::format("  {} /{}{:<1}", cell(row, "force_off_max", 6, 2), cell(row, "force_angle_max_deg", 6, 1),
                              figureOf(row, "missed_ticks") > 0 ? "!" : "");
  }
  flush();
  return text;
}

// Recovery on and off, of those that renew planes.
std::string recoveryTable(const BenchResult& result) {
  std::string text;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "effects" || !textOf(row, "algorithm").starts_with("hri")) continue;
    text += fmt::format(
        "  {:<14} n={:<3g} {:g} m/s, {:g} voxel deep, {:<8}  jump {} N, on concave regions {} N, mean {} N\n",
        textOf(row, "algorithm"), figureOf(row, "n_ticks"), figureOf(row, "speed_m_per_s"),
        figureOf(row, "depth_voxel"), textOf(row, "effects"), cell(row, "force_jump_max_N", 6, 3),
        cell(row, "force_jump_concave_max_N", 6, 3), cell(row, "force_mean_N", 6, 3));
  }
  return text.empty() ? text : "recovery time of 20 ms on the knot of 128x128x64, and none\n" + text;
}

}  // namespace

std::string servoIntroduction() {
  return "Every algorithm of the registry along the same paths, in one process, interleaved: each repetition goes "
         "round all of "
         "them and\nbegins with another one. The tool follows the phantom's exact surface at 0.1 m/s, 1 voxel below "
         "it, in a "
         "direction that turns slowly\nby chance, 1000 ticks a second, K = 500 N/m, B = 0, windows of 32 x 32 x 32 "
         "samples as in "
         "the program.\n\n"
         "- *Cost, mean*: median over repetitions of a replay's time divided by its ticks, so that the clock's own "
         "cost stays "
         "out. Each\n  tick's position depends on the last tick's force, as in a loop, where ticks do not overlap. "
         "What this "
         "harness costs by itself\n  stands below the tables and is not taken off. p99, p99.9 and maximum: over ticks, "
         "the "
         "fastest of several replays of each, the\n  clock's median cost taken off; the raw figures are in the JSON.\n"
         "- *VHIP*: its distance from the exact surface. *Force*: | |F| - K depth | / (K depth), depth of the tool "
         "below the "
         "exact surface.\n  *Angle*: between the force and the exact normal. *Jump*: largest change of the force from "
         "one tick "
         "to the next. *Falls*: how\n  often contact was lost while the tool was more than 0.25 voxel inside.\n"
         "- *Strokes*: a rigid hand right through a wall, from a random side, at up to 45 degrees, counted until K "
         "times the way "
         "past the wall\n  reaches 8 N. Missed: never felt. Lost: felt and let go.\n"
         "- *Noise and depth*: the same path, deeper, over samples with noise; noise is told as how far it moves the "
         "surface, and errors\n  are against the surface without it. *Speeds*: 2 mm deep, any n.\n"
         "- *hri-paper* is the paper's Figure 2 to the letter, and stands for the paper wherever one name does; "
         "*hri-paper-line* is the other\n  reading of its text (docs/hri-mends.md). *haptization* shows no surface, "
         "and K means nothing to it: it has no VHIP error and no error of the force.\n"
         "- Windows follow as in the program, around the surface where an algorithm says that it holds one and "
         "otherwise around the tool,\n  without delay.\n\n"
         "Exact places: `apps/bench/*.hpp`. Costs are compared within a run only; figures of correctness are the same "
         "on every "
         "machine.";
}

std::string servoTable(const BenchResult& result) {
  std::string text, last;
  for (const BenchRow& row : result.rows) {
    const std::string part = textOf(row, "part");
    if (part != "tick" && part != "accuracy") continue;
    const std::string title =
        fmt::format("{} ({})", textOf(row, "volume"), part == "tick" ? "cost and error" : "long path");
    if (title != last) text += fmt::format("{}\n{}", title, head());
    last = title;
    text += part == "tick" ? tickLine(row) : accuracyLine(row);
  }
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "harness") continue;
    text += fmt::format(
        "a tick that does nothing {:.1f} ns (in all figures), one without renewal {:.1f} ns, clock {:.0f} ns\n",
        figureOf(row, "empty_tick_ns"), figureOf(row, "hri_without_renewal_ns"), figureOf(row, "clock_ns"));
  }
  return text + strokeTable(result) + recoveryTable(result) + speedTable(result) + pressTable(result);
}

}  // namespace palpate
