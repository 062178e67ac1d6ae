// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/servo_targets.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "apps/bench/press_rows.hpp"
#include "base/quantile.hpp"

namespace palpate {
namespace {

constexpr double kFastestThinWallStroke_m_per_s = 1;

using Rows = std::vector<const BenchRow*>;

Rows select(const BenchResult& result, const char* part, const std::function<bool(const BenchRow&)>& wanted) {
  Rows rows;
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") == part && wanted(row)) rows.push_back(&row);
  }
  return rows;
}

Rows selectAlgorithm(const BenchResult& result, const char* part, const std::string& algorithm, int n) {
  return select(result, part, [&](const BenchRow& row) {
    return textOf(row, "algorithm") == algorithm && figureOf(row, "n_ticks") == n;
  });
}

std::vector<double> figures(const Rows& rows, const char* key) {
  std::vector<double> values;
  for (const BenchRow* row : rows) values.push_back(figureOf(*row, key));
  return values;
}

// With a note instead where there are no rows.
void addOver(BenchResult& result, const std::string& name, const Rows& rows, double bound,
             const std::function<double(const Rows&)>& value) {
  if (rows.empty()) {
    result.note(fmt::format("target '{}' is left out: what it needs took no part", name));
  } else {
    result.targets.push_back({name, value(rows), bound});
  }
}

void addRatio(BenchResult& result, const std::string& rival, double bound) {
  const Rows rows = select(result, "ratio", [&](const BenchRow& row) { return textOf(row, "algorithm") == rival; });
  addOver(result, fmt::format("hri / {}, cost of a tick at n=5, median of the volumes [-]", rival), rows, bound,
          [](const Rows& r) { return median(figures(r, "hri_over_it")); });
  const std::vector<double> ratios = figures(rows, "hri_over_it");
  if (!ratios.empty()) {
    result.note(fmt::format("hri / {}, cost of a tick at n=5: {:.2f} on the worst of the volumes, {:.2f} on the best",
                            rival, *std::max_element(ratios.begin(), ratios.end()),
                            *std::min_element(ratios.begin(), ratios.end())));
  }
}

void addCosts(BenchResult& result) {
  const auto harness = [](const BenchRow&) { return true; };
  addOver(result, "hri, tick without renewal [ns]", select(result, "harness", harness), 15,
          [](const Rows& r) { return figureOf(*r.front(), "hri_without_renewal_ns"); });
  addOver(result, "hri, renewal every tick (n=1), median of the volumes [ns]",
          selectAlgorithm(result, "tick", "hri", 1), 100, [](const Rows& r) { return median(figures(r, "cost_ns")); });
  addOver(result, "hri, mean at n=5, median of the volumes [ns]", selectAlgorithm(result, "tick", "hri", 5), 35,
          [](const Rows& r) { return median(figures(r, "cost_ns")); });
}

// The largest ratio over the volumes that both have: on none may it be above 1.
void addErrorAgainstBlezek(BenchResult& result) {
  const Rows ours = selectAlgorithm(result, "tick", "hri", 5);
  const Rows theirs = selectAlgorithm(result, "tick", "blezek", 5);
  addOver(result, "hri / blezek, median VHIP error at n=5, worst volume [-]", theirs, 1, [&](const Rows& r) {
    double worst = 0;
    for (const BenchRow* its : r) {
      for (const BenchRow* own : ours) {
        if (textOf(*own, "volume") != textOf(*its, "volume")) continue;
        worst = std::max(worst, figureOf(*own, "vhip_error_median_voxel") / figureOf(*its, "vhip_error_median_voxel"));
      }
    }
    return worst;
  });
}

void addAccuracy(BenchResult& result) {
  for (const auto& [n, angle_bound] : {std::pair{1, 0.35}, std::pair{5, 0.7}}) {
    const Rows rows = selectAlgorithm(result, "accuracy", "hri", n);
    const auto first = [](const char* key) { return [key](const Rows& r) { return figureOf(*r.front(), key); }; };
    addOver(result, fmt::format("hri, knot 128x128x64, n={}, median VHIP error [voxel]", n), rows, 0.015,
            first("vhip_error_median_voxel"));
    addOver(result, fmt::format("hri, knot 128x128x64, n={}, median force angle [degree]", n), rows, angle_bound,
            first("force_angle_median_deg"));
    addOver(result, fmt::format("hri, knot 128x128x64, n={}, fall-throughs [-]", n), rows, 0, first("fall_throughs"));
  }
}

void addStrokes(BenchResult& result) {
  const Rows rows = select(result, "strokes", [](const BenchRow& row) {
    return textOf(row, "algorithm") == "hri" && textOf(row, "wall") == "shell of 1 voxel" &&
           figureOf(row, "speed_m_per_s") <= kFastestThinWallStroke_m_per_s;
  });
  addOver(result, "hri, one-voxel shell up to 1 m/s, missed or lost contacts [-]", rows, 0, [](const Rows& r) {
    double sum = 0;
    for (const BenchRow* row : r) sum += figureOf(*row, "missed") + figureOf(*row, "lost");
    return sum;
  });
}

// NaN where one is none.
double largest(const Rows& rows, const char* key) {
  const std::vector<double> values = figures(rows, key);
  const auto none = std::find_if(values.begin(), values.end(), [](double v) { return std::isnan(v); });
  if (none != values.end()) return *none;
  return *std::max_element(values.begin(), values.end());
}

// Over all speeds up to the fastest promised and every n.
void addSpeeds(BenchResult& result, const char* volume, const std::string& words, double fastest_m_per_s,
               double force_bound, double angle_bound_deg) {
  const Rows rows = select(result, "speed", [&](const BenchRow& row) {
    return textOf(row, "algorithm") == "hri" && textOf(row, "volume") == volume &&
           figureOf(row, "speed_m_per_s") <= fastest_m_per_s;
  });
  const std::string range = fmt::format("hri, {}, 2 mm deep, up to {:g} m/s, any n", words, fastest_m_per_s);
  addOver(result, range + ", force over K depth or its inverse [-]", rows, force_bound,
          [](const Rows& r) { return largest(r, "force_off_max"); });
  addOver(result, range + ", force angle [degree]", rows, angle_bound_deg,
          [](const Rows& r) { return largest(r, "force_angle_max_deg"); });
  addOver(result, range + ", contacts lost [-]", rows, 0, [](const Rows& r) { return largest(r, "fall_throughs"); });
  addOver(result, range + ", ticks with a fault that fades [-]", rows, 0,
          [](const Rows& r) { return largest(r, "fading_fault_ticks"); });
}

void addPresses(BenchResult& result) {
  const Rows rows = select(result, "press", [](const BenchRow& row) { return textOf(row, "algorithm") == "hri"; });
  addOver(result, "hri, noise up to 0.5 voxel, 1 to 24 voxels deep, contacts lost [-]", rows, 0, [](const Rows& r) {
    double sum = 0;
    for (const BenchRow* row : r) sum += figureOf(*row, "fall_throughs");
    return sum;
  });
  addOver(result, "hri, noise up to 0.5 voxel, 1 to 24 voxels deep, ticks with a fault that fades [-]", rows, 0,
          [](const Rows& r) { return largest(r, "fading_fault_ticks"); });
}

// Where another algorithm with a VHIP has a smaller 99th percentile of the angle in the same press, though hri may
// renew its plane as often: said, so that nobody has to look for it.
void notePressesThatHriDoesNotWin(BenchResult& result) {
  constexpr double kClearly = 0.95;
  const auto isOf = [](const BenchRow& row, const BenchRow& place) {
    return textOf(row, "volume") == textOf(place, "volume") &&
           figureOf(row, "noise_voxel") == figureOf(place, "noise_voxel") &&
           figureOf(row, "depth_voxel") == figureOf(place, "depth_voxel");
  };
  const Rows ours = selectAlgorithm(result, "press", "hri", 1);
  std::size_t lost = 0;
  for (const BenchRow* place : ours) {
    const Rows better = select(result, "press", [&](const BenchRow& row) {
      return isOf(row, *place) && textOf(row, "algorithm") != "hri" &&
             figureOf(row, "missed_ticks") <= figureOf(*place, "missed_ticks") &&
             !std::isnan(figureOf(row, "vhip_error_median_voxel")) && figureOf(row, "contact_ticks") > 0 &&
             figureOf(row, "force_angle_p99_deg") < kClearly * figureOf(*place, "force_angle_p99_deg");
    });
    lost += better.empty() ? 0 : 1;
  }
  if (!ours.empty()) {
    result.note(
        fmt::format("in {} of {} presses by noise and depth another algorithm's 99th percentile of the angle is "
                    "more than 5 % below that of hri at n=1, and it loses no more contact",
                    lost, ours.size()));
  }
}

}  // namespace

void addServoTargets(BenchResult& result) {
  addRatio(result, "avila", 0.8);
  addRatio(result, "blezek", 0.33);
  addErrorAgainstBlezek(result);
  addCosts(result);
  addAccuracy(result);
  addStrokes(result);
  addSpeeds(result, kBall20mm, "ball of 20 mm, voxels of 0.5 mm", 2, 1.1, 8);
  addSpeeds(result, kTubeOf8, "knot's tube of 8 voxels", 0.5, 1.2, 15);
  addPresses(result);
  notePressesThatHriDoesNotWin(result);
}

}  // namespace palpate
