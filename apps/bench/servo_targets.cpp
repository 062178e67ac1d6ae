// SPDX-License-Identifier: Apache-2.0
// The promises of `palpate bench servo`.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/bench/servo_bench.hpp"

namespace palpate {
namespace {

BenchRow like(const std::string& algorithm, std::int64_t n) {
  return {{"algorithm", algorithm}, {"n_ticks", n}};
}

// Adds a target; or a note, if there are no rows for it.
void add(BenchResult& result, const Promise& what) {
  if (!promise(result, what)) {
    result.note(fmt::format("target '{}' is left out: what it needs took no part", what.name));
  }
}

void addRatio(BenchResult& result, const std::string& rival, double bound) {
  const BenchRow likes = {{"algorithm", rival}};
  const std::string words = fmt::format("hri / {}, cost of a tick at n=5", rival);
  add(result, {words + ", median of the volumes [-]", bound, "ratio", likes, {"hri_over_it"}, medianOf});
  std::vector<double> ratios;
  for (const BenchRow* row : rowsOf(result, "ratio", likes)) ratios.push_back(figureOf(*row, "hri_over_it"));
  if (ratios.empty()) return;
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  result.note(fmt::format("{}: {:.2f} on the worst of the volumes, {:.2f} on the best", words, *most, *least));
}

// The ratio of hri's VHIP error to blezek's. On no volume that both have may it be above 1.
void addErrorAgainstBlezek(BenchResult& result) {
  BenchResult ratios;
  for (const BenchRow* its : rowsOf(result, "tick", like("blezek", 5))) {
    BenchRow same = like("hri", 5);
    same.emplace_back("volume", textOf(*its, "volume"));
    for (const BenchRow* own : rowsOf(result, "tick", same)) {
      const double ratio = figureOf(*own, "vhip_error_median_voxel") / figureOf(*its, "vhip_error_median_voxel");
      ratios.rows.push_back({{"part", "error"}, {"ratio", ratio}});
    }
  }
  add(ratios, {"hri / blezek, median VHIP error at n=5, worst volume [-]", 1, "error", {}, {"ratio"}, largestOf});
  std::move(ratios.targets.begin(), ratios.targets.end(), std::back_inserter(result.targets));
  for (const BenchRow* note : rowsOf(ratios, "note")) result.rows.push_back(*note);
}

std::vector<Promise> promisesOfHri() {
  std::vector<Promise> list = {
      {"hri, tick without renewal [ns]", 15, "harness", {}, {"hri_without_renewal_ns"}, firstOf},
      {"hri, renewal every tick (n=1), median of the volumes [ns]", 100, "tick", like("hri", 1), {"cost_ns"}, medianOf},
      {"hri, mean at n=5, median of the volumes [ns]", 35, "tick", like("hri", 5), {"cost_ns"}, medianOf}};
  for (const auto& [n, angle_deg] : {std::pair{1, 0.35}, std::pair{5, 0.7}}) {
    const std::string on = fmt::format("hri, knot 128x128x64, n={}, ", n);
    const BenchRow rows = like("hri", n);
    list.push_back({on + "median VHIP error [voxel]", 0.015, "accuracy", rows, {"vhip_error_median_voxel"}, firstOf});
    list.push_back(
        {on + "median force angle [degree]", angle_deg, "accuracy", rows, {"force_angle_median_deg"}, firstOf});
    list.push_back({on + "fall-throughs [-]", 0, "accuracy", rows, {"fall_throughs"}, firstOf});
  }
  list.push_back({"hri, one-voxel shell up to 1 m/s, missed or lost contacts [-]",
                  0,
                  "strokes",
                  {{"algorithm", "hri"}, {"wall", "shell of 1 voxel"}},
                  {"missed", "lost"},
                  sumOf,
                  1});
  // Promises for all speeds up to a fastest one, and for every n.
  struct Speeds {
    const char* volume;
    const char* words;
    double fastest_m_per_s, force_off, angle_deg;
  };
  for (const Speeds& s : {Speeds{kBall20mm, "ball of 20 mm, voxels of 0.5 mm", 2, 1.1, 8},
                          Speeds{kTubeOf8, "knot's tube of 8 voxels", 0.5, 1.2, 15}}) {
    const std::string on = fmt::format("hri, {}, 2 mm deep, up to {:g} m/s, any n, ", s.words, s.fastest_m_per_s);
    const auto most = [&](const char* what, double bound, const char* key) {
      list.push_back({on + what,
                      bound,
                      "speed",
                      {{"algorithm", "hri"}, {"volume", s.volume}},
                      {key},
                      largestOf,
                      s.fastest_m_per_s});
    };
    most("force over K depth or its inverse [-]", s.force_off, "force_off_max");
    most("force angle [degree]", s.angle_deg, "force_angle_max_deg");
    most("contacts lost [-]", 0, "fall_throughs");
    most("ticks with a fault that fades [-]", 0, "fading_fault_ticks");
  }
  const BenchRow hri = {{"algorithm", "hri"}};
  const std::string deep = "hri, noise up to 0.5 voxel, 1 to 24 voxels deep, ";
  list.push_back({deep + "contacts lost [-]", 0, "press", hri, {"fall_throughs"}, sumOf});
  list.push_back({deep + "ticks with a fault that fades [-]", 0, "press", hri, {"fading_fault_ticks"}, largestOf});
  return list;
}

// Notes in how many presses another algorithm with a VHIP has a smaller 99th percentile of the angle than hri at n = 1,
// so that nobody has to search for them.
void notePressesThatHriDoesNotWin(BenchResult& result) {
  constexpr double kClearly = 0.95;
  const BenchRows ours = rowsOf(result, "press", like("hri", 1));
  std::size_t lost = 0;
  for (const BenchRow* place : ours) {
    const auto isBetter = [&](const BenchRow* row) {
      return textOf(*row, "algorithm") != "hri" && figureOf(*row, "missed_ticks") <= figureOf(*place, "missed_ticks") &&
             !std::isnan(figureOf(*row, "vhip_error_median_voxel")) && figureOf(*row, "contact_ticks") > 0 &&
             figureOf(*row, "force_angle_p99_deg") < kClearly * figureOf(*place, "force_angle_p99_deg");
    };
    const BenchRows there = rowsOf(result, "press",
                                   {{"volume", textOf(*place, "volume")},
                                    {"noise_voxel", figureOf(*place, "noise_voxel")},
                                    {"depth_voxel", figureOf(*place, "depth_voxel")}});
    lost += std::any_of(there.begin(), there.end(), isBetter) ? 1 : 0;
  }
  if (!ours.empty()) {
    result.note(
        fmt::format("in {} of {} presses by noise and depth another algorithm's 99th percentile "
                    "of the angle is more than 5 % below that of hri at n=1, and it loses no more contact",
                    lost, ours.size()));
  }
}

}  // namespace

void addServoTargets(BenchResult& result) {
  addRatio(result, "avila", 0.8);
  addRatio(result, "blezek", 0.33);
  addErrorAgainstBlezek(result);
  for (const Promise& what : promisesOfHri()) add(result, what);
  notePressesThatHriDoesNotWin(result);
}

}  // namespace palpate
