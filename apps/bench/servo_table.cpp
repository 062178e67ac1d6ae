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
