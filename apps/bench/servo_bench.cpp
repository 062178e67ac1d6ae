// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/servo_bench.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "apps/bench/error_row.hpp"
#include "apps/bench/log_chart.hpp"
#include "apps/bench/press_rows.hpp"
#include "apps/bench/recovery_rows.hpp"
#include "apps/bench/servo_targets.hpp"
#include "apps/bench/strokes.hpp"
#include "apps/bench/table_one.hpp"
#include "apps/bench/tick_cost.hpp"
#include "apps/console/interrupt.hpp"
#include "base/quantile.hpp"
#include "servo/loop/real_time.hpp"

namespace palpate {
namespace {

constexpr const char* kServoBench = "palpate bench servo";

BenchRow rowOf(const char* part, const BenchVolume& volume, const Entrant& entrant, std::uint64_t seed) {
  return {{"part", part},
          {"volume", volume.name()},
          {"algorithm", entrant.algorithm},
          {"n_ticks", std::int64_t{entrant.n}},
          {"seed", static_cast<std::int64_t>(seed)}};
}

BenchRow costRow(const TickCost& cost) {
  const Spread batch = spreadOf(cost.batch_ns);
  return {{"cost_ns", batch.median},
          {"cost_quartile_1_ns", batch.low},
          {"cost_quartile_3_ns", batch.high},
          {"tick_median_ns", cost.fastest_ns.p50},
          {"tick_p99_ns", cost.fastest_ns.p99},
          {"tick_p999_ns", cost.fastest_ns.p999},
          {"tick_max_ns", cost.fastest_ns.max},
          {"tick_raw_median_ns", cost.raw_ns.p50},
          {"tick_raw_p99_ns", cost.raw_ns.p99},
          {"tick_raw_p999_ns", cost.raw_ns.p999},
          {"tick_raw_max_ns", cost.raw_ns.max}};
}

// Cost of hri against the others', repetition by repetition: both were replayed one after the other in each.
void addRatios(const BenchVolume& volume, const std::vector<Entrant>& entrants, const std::vector<TickCost>& costs,
               BenchResult& result) {
  const auto hri = std::find_if(entrants.begin(), entrants.end(),
                                [](const Entrant& e) { return e.algorithm == "hri" && e.n == kTableRenewal; });
  if (hri == entrants.end()) return;
  const std::vector<double>& ours_ns = costs[static_cast<std::size_t>(hri - entrants.begin())].batch_ns;
  for (std::size_t e = 0; e < entrants.size(); ++e) {
    if (entrants[e].n != kTableRenewal || entrants[e].algorithm == "hri") continue;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours_ns.size(); ++i) ratios.push_back(ours_ns[i] / costs[e].batch_ns[i]);
    const Spread ratio = spreadOf(std::move(ratios));
    result.rows.push_back({{"part", "ratio"},
                           {"volume", volume.name()},
                           {"algorithm", entrants[e].algorithm},
                           {"n_ticks", std::int64_t{kTableRenewal}},
                           {"hri_over_it", ratio.median},
                           {"hri_over_it_quartile_1", ratio.low},
                           {"hri_over_it_quartile_3", ratio.high}});
  }
}

class ServoBench {
 public:
  ServoBench(const ServoBenchRequest& request, Progress& progress) : request_(request), progress_(progress) {
    result_.bench = "servo";
    result_.machine = machineInWords();
  }

  BenchResult run() {
    for (const std::string& name : request_.volumes) touch(name);
    for (const std::string& name : request_.accuracy_volumes) accuracy(name);
    strokes("shell of 1 voxel", "phantom:shell?size=64&thickness=1", true);
    strokes("shell of 1.2 voxels", "phantom:shell?size=64&thickness=1.2", true);
    strokes("shell of 2 voxels", "phantom:shell?size=64&thickness=2", true);
    strokes("knot", "phantom:knot?size=64", false);
    presses();
    speeds();
    progress_.stage("Table 1 with noise and depth");
    addTableTrial({.volumes = request_.volumes,
                   .ticks = request_.cost_ticks,
                   .cost = {.repetitions = request_.repetitions, .tick_replays = 0},
                   .seed = request_.seed},
                  result_, step());
    addServoTargets(result_);
    return std::move(result_);
  }

 private:
  [[nodiscard]] BenchProgress step() {
    return [this](double share) {
      progress_.fraction(share);
      throwIfInterrupted(kServoBench);
    };
  }

  [[nodiscard]] ContactPath path(const BenchVolume& volume, std::size_t ticks) const {
    return contactPath(volume, {.rate_hz = kBenchRate_hz, .ticks = ticks, .seed = request_.seed});
  }

  // Once for each algorithm, not for each volume.
  void noteLeftOut(const Entrants& entrants) {
    for (const std::string& words : entrants.left_out) {
      if (noted_.insert(words).second) result_.note("left out: " + words);
    }
  }

  // Cost and error on one of the paper's volumes.
  void touch(const std::string& name) {
    progress_.stage("errors on " + name);
    const BenchVolume volume(name);
    Entrants entrants = makeEntrants(volume, request_.renewals);
    noteLeftOut(entrants);
    const auto errors = touchErrors(volume, path(volume, request_.error_ticks), entrants.list, step());
    progress_.stage("costs on " + name);
    const ReplayPath replay(volume, path(volume, request_.cost_ticks));
    const auto costs = tickCosts(replay, entrants.list, {request_.repetitions, request_.tick_replays}, step());
    for (std::size_t e = 0; e < entrants.list.size(); ++e) {
      BenchRow row = rowOf("tick", volume, entrants.list[e], request_.seed);
      addCells(row, costRow(costs[e]));
      addCells(row, errorRow(errors[e]));
      result_.rows.push_back(std::move(row));
    }
    addRatios(volume, entrants.list, costs, result_);
    if (name == request_.volumes.front()) harness(volume, replay);
  }

  // A tick that only pushes: the tool trembles by a hundredth of a voxel on the spot, the plane is kept for ever.
  void harness(const BenchVolume& volume, const ReplayPath& replay) {
    ContactPath held = path(volume, 1);
    const Vec3 spot_W = held.hip_W.back();
    const Vec3 normal_W = held.normal_W.back();
    const Vec3 aside_W = normal_W.unitOrthogonal() * (0.01 * volume.voxel_m());
    held.slide_begin = held.hip_W.size() - 1;
    for (std::size_t k = 1; k < request_.cost_ticks; ++k) {
      held.hip_W.push_back(k % 2 == 0 ? spot_W : Vec3(spot_W + aside_W));
      held.velocity_W.push_back(Vec3::Zero());
    }
    held.normal_W.resize(held.hip_W.size(), normal_W);
    held.depth_m.resize(held.hip_W.size(), held.depth_m.back());
    held.exact.resize(held.hip_W.size(), 1);
    const ReplayPath trembling(volume, std::move(held));
    std::vector<double> held_ns;
    Entrants entrants = makeEntrants(volume, {1 << 30});
    for (Entrant& entrant : entrants.list) {
      for (int i = 0; entrant.algorithm == "hri" && i < request_.repetitions; ++i) {
        held_ns.push_back(trembling.replay_ns(*entrant.haptic));
      }
    }
    const Spread spread = spreadOf(std::move(held_ns));
    result_.rows.push_back({{"part", "harness"},
                            {"volume", volume.name()},
                            {"clock_ns", clockCost_ns()},
                            {"empty_tick_ns", harnessCost_ns(replay)},
                            {"hri_without_renewal_ns", spread.median},
                            {"hri_without_renewal_quartile_1_ns", spread.low},
                            {"hri_without_renewal_quartile_3_ns", spread.high}});
  }

  void accuracy(const std::string& name) {
    progress_.stage("accuracy on " + name);
    const BenchVolume volume(name);
    const ContactPath way = path(volume, request_.accuracy_ticks);
    Entrants entrants = makeEntrants(volume, request_.renewals);
    const auto errors = touchErrors(volume, way, entrants.list, step());
    for (std::size_t e = 0; e < entrants.list.size(); ++e) {
      BenchRow row = rowOf("accuracy", volume, entrants.list[e], request_.seed);
      addCells(row, errorRow(errors[e]));
      result_.rows.push_back(std::move(row));
    }
    if (name == request_.accuracy_volumes.front())
      addRecoveryRows(volume, request_.accuracy_ticks, request_.seed, result_, step());
  }

  void presses() {
    for (const auto& [volume, depths_voxel] :
         {std::pair{kBall20mm, std::vector<double>{1, 4, 12, 24}}, {kTubeOf8, std::vector<double>{1, 4}}}) {
      progress_.stage(fmt::format("noise and depth on {}", volume));
      addPressRows({.volume = volume,
                    .depths_voxel = depths_voxel,
                    .ticks = request_.press_ticks,
                    .first_seed = request_.seed,
                    .seeds = request_.press_seeds},
                   result_, step());
    }
  }

  // 2 mm deep both.
  void speeds() {
    progress_.stage("speeds");
    addSpeedRows({.volume = kBall20mm,
                  .depth_voxel = 4,
                  .speeds_m_per_s = {0.05, 0.1, 0.25, 0.5, 1, 1.5, 2},
                  .ticks = request_.press_ticks,
                  .seed = request_.seed},
                 result_, step());
    addSpeedRows({.volume = kTubeOf8,
                  .depth_voxel = 2,
                  .speeds_m_per_s = {0.05, 0.1, 0.25, 0.5},
                  .ticks = request_.press_ticks,
                  .seed = request_.seed},
                 result_, step());
  }

  void strokes(const std::string& wall, const std::string& name, bool thin) {
    progress_.stage("strokes into a " + wall);
    const BenchVolume volume(name);
    Entrants entrants = makeEntrants(volume, {kTableRenewal});
    StrokeRequest request;
    request.strokes = request_.strokes;
    request.thin_wall = thin;
    request.seed = request_.seed;
    const auto figures = strokeFigures(volume, request, entrants.list, step());
    for (std::size_t e = 0; e < entrants.list.size(); ++e) {
      for (const StrokeFigures& f : figures[e]) {
        BenchRow row = rowOf("strokes", volume, entrants.list[e], request_.seed);
        addCells(row, {{"wall", wall},
                       {"speed_m_per_s", f.speed_m_per_s},
                       {"strokes", f.strokes},
                       {"strokes_over_holes_in_samples", f.over_hole},
                       {"missed", f.missed},
                       {"lost", f.lost}});
        result_.rows.push_back(std::move(row));
      }
    }
  }

  ServoBenchRequest request_;
  Progress& progress_;
  BenchResult result_;
  std::set<std::string> noted_;
};

// Medians over the volumes, of the cost and of the error each.
ChartPanel panel(const BenchResult& result, const std::string& title, const char* key, const std::string& label) {
  struct Values {
    std::vector<double> cost_ns, error;
  };
  std::vector<std::string> algorithms;
  std::map<std::pair<std::string, double>, Values> values;  // by algorithm and n
  for (const BenchRow& row : result.rows) {
    if (textOf(row, "part") != "tick" || std::isnan(figureOf(row, key))) continue;
    const std::string algorithm = textOf(row, "algorithm");
    if (std::find(algorithms.begin(), algorithms.end(), algorithm) == algorithms.end()) algorithms.push_back(algorithm);
    Values& at = values[{algorithm, figureOf(row, "n_ticks")}];
    at.cost_ns.push_back(figureOf(row, "cost_ns"));
    at.error.push_back(figureOf(row, key));
  }
  ChartPanel panel{title, "cost of a tick [ns]", label, {}};
  for (const std::string& algorithm : algorithms) {
    ChartSeries& series = panel.series.emplace_back(ChartSeries{algorithm, {}});
    for (const auto& [which, v] : values) {
      if (which.first != algorithm) continue;
      series.points.push_back({median(v.cost_ns), median(v.error), fmt::format("n={:g}", which.second)});
    }
    // An algorithm that keeps no plane has the same errors, bit for bit, whatever n is: one point, at its middle cost.
    const auto differs = [&](const ChartPoint& point) { return point.y != series.points.front().y; };
    if (series.points.size() < 2 || std::any_of(series.points.begin(), series.points.end(), differs)) continue;
    std::vector<double> costs_ns;
    for (const ChartPoint& point : series.points) costs_ns.push_back(point.x);
    series.points = {{median(std::move(costs_ns)), series.points.front().y, "any n"}};
  }
  return panel;
}

}  // namespace

ServoBenchRequest ServoBenchRequest::quick() {
  ServoBenchRequest request;
  request.cost_ticks = 2000;
  request.repetitions = 9;
  request.tick_replays = 5;
  request.error_ticks = 2000;
  request.accuracy_ticks = 10000;
  request.strokes = 30;
  request.press_ticks = 1000;
  request.press_seeds = 1;
  return request;
}

BenchResult runServoBench(const ServoBenchRequest& request, Progress& progress) {
  return ServoBench(request, progress).run();
}

std::string servoChart(const BenchResult& result) {
  return logChartSvg("Cost against error: medians over the volumes",
                     {panel(result, "position", "vhip_error_median_voxel", "VHIP error, median [voxel]"),
                      panel(result, "direction", "force_angle_median_deg", "angle of the force, median [degree]")},
                     ChartMarks::kPoints);
}

}  // namespace palpate
