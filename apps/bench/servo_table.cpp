// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/bench/servo_bench.hpp"

namespace palpate {
namespace {

std::string tickLine(const BenchRow& row) {
  const auto f = [&](const char* key) { return figureOf(row, key); };
  return fmt::format(
      "  {:<12} {:>3g}  {:>7.1f} {:>7.0f} {:>7.0f} {:>7.0f}  {:>7.4f} {:>7.4f}  {:>7.3f} {:>7.3f}  {:>7.2f} {:>7.2f}  "
      "{:>7.3f}  {:>6g}\n",
      textOf(row, "algorithm"), f("n_ticks"), f("cost_ns"), f("tick_p99_ns"), f("tick_p999_ns"), f("tick_max_ns"),
      f("vhip_error_median_voxel"), f("vhip_error_p99_voxel"), f("force_error_median_percent"),
      f("force_error_p99_percent"), f("force_angle_median_deg"), f("force_angle_p99_deg"), f("force_jump_max_N"),
      f("fall_throughs"));
}

std::string accuracyLine(const BenchRow& row) {
  const auto f = [&](const char* key) { return figureOf(row, key); };
  return fmt::format(
      "  {:<12} {:>3g}  {:>33}  {:>7.4f} {:>7.4f}  {:>7.3f} {:>7.3f}  {:>7.2f} {:>7.2f}  {:>7.3f}  {:>6g}\n",
      textOf(row, "algorithm"), f("n_ticks"), "", f("vhip_error_median_voxel"), f("vhip_error_p99_voxel"),
      f("force_error_median_percent"), f("force_error_p99_percent"), f("force_angle_median_deg"),
      f("force_angle_p99_deg"), f("force_jump_max_N"), f("fall_throughs"));
}

constexpr const char* kHead =
    "  {:<12} {:>3}  {:^33}  {:^15}  {:^15}  {:^15}  {:>7}  {:>6}\n"
    "  {:<12} {:>3}  {:>7} {:>7} {:>7} {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>7} {:>7}  {:>7}  {:>6}\n";

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
    const std::string line = fmt::format("{:<20} {:<12}", textOf(row, "wall"), textOf(row, "algorithm"));
    if (line != last) text += (text.empty() ? "" : "\n") + ("  " + line);
    last = line;
    text += fmt::format("  {:g}+{:g}/{:g}", figureOf(row, "missed"), figureOf(row, "lost"), figureOf(row, "strokes"));
  }
  return text.empty() ? text : "strokes missed + lost / all at 0.05, 0.1, 0.2, 0.5, 1, 2 m/s\n" + text + "\n";
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
         "past the wall\n  reaches 8 N. Missed: never felt. Lost: felt and let go. Windows follow without delay.\n\n"
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
  return text + strokeTable(result);
}

}  // namespace palpate
