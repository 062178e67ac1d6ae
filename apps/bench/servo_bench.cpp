// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/servo_bench.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "apps/bench/strokes.hpp"
#include "apps/bench/tick_cost.hpp"
#include "apps/console/interrupt.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

// The condition of a run over a volume, which its rows report.
struct Condition {
  std::int64_t seed = 1, seeds = 1;
  double noise_voxel = 0, depth_voxel = 1, speed_m_per_s = 0.1;
  std::string effects = "none";
};
const Column<Condition> kTellSeed = {"seed", &Condition::seed};
const Column<Condition> kTellSeeds = {"seeds", &Condition::seeds};
const Column<Condition> kTellNoise = {"noise_voxel", &Condition::noise_voxel};
const Column<Condition> kTellDepth = {"depth_voxel", &Condition::depth_voxel};
const Column<Condition> kTellSpeed = {"speed_m_per_s", &Condition::speed_m_per_s};
const Column<Condition> kTellEffects = {"effects", &Condition::effects};
const Column<Condition> kTellRecovery = {"recovery_s", [](const Condition&) { return kRecoveryTime_s; }};

// Who takes part in a trial.
using Who = std::function<std::vector<Entrant>(const BenchVolume&)>;

// Every n of the list; an algorithm that renews no planes takes part only with the first.
Who once(std::vector<int> renewals) {
  return [renewals](const BenchVolume& volume) {
    std::vector<Entrant> list = makeEntrants(volume, renewals).list;
    std::erase_if(list, [&](const Entrant& e) { return !e.traits.renews_planes && e.n != renewals.front(); });
    return list;
  };
}

// The algorithms that support contact effects, with a recovery time and without.
Who withEffects(int n) {
  return [n](const BenchVolume& volume) { return makeEntrants(volume, {n}, {"none", kRecoveryChoice}).list; };
}

std::vector<Entrant> ofTableOne(const BenchVolume& volume) {
  std::vector<Entrant> list = makeEntrants(volume, {kTableRenewal}).list;
  std::erase_if(list, [](const Entrant& entrant) {
    return std::ranges::find(kTableAlgorithms, entrant.algorithm, &TableAlgorithm::name) == std::end(kTableAlgorithms);
  });
  return list;
}

// Lets algorithms follow paths over one volume; their errors and costs become rows.
struct Trial {
  const char* part;
  std::string stage;
  std::string volume;
  Who entrants;
  std::size_t ticks;
  Columns<Condition> told;  // columns of the condition, before a row's figures
  std::vector<double> depths_voxel = {1}, speeds_m_per_s = {0.1};
  double noise_voxel = 0;  // in the samples only; path, depth and normal are those of the exact surface
  double miss_depth_voxel = kMissDepth_voxel;
  int seeds = 1;                      // of noise and path
  bool may_be_thin = false;           // a volume that can nowhere be pressed so deep has no row; else it is an error
  std::optional<CostRequest> cost{};  // costs along a path of cost_ticks; without single ticks only their mean
  bool recovers = false;              // rows have the columns of force jumps only
};

// The conditions under which recovery time is tried, 1 voxel deep.
struct RecoveryCondition {
  int n_ticks = 1;
  double speed_m_per_s = 0.1;
};
constexpr RecoveryCondition kRecoveryConditions[] = {
    // The targets are for this one. Planes are renewed seldom, so switches are felt; between switches the contact is
    // steady. The hand is slow: on a surface of radius R, planes that are n ticks apart err in depth by
    // (v n T)^2 / (2 R). Recovery keeps this error for a while, so the mean force of a fast hand would differ by more
    // than the target allows.
    {.n_ticks = 20, .speed_m_per_s = 0.02},
    // Here recovery matters. The paper renewed its planes this seldom (section 4: "50 to 10 times slower than the servo
    // loop"), and the hand moves as fast as usual. There is no target: an algorithm that renews a plane before it is
    // that wrong has little to recover from, and recovery cannot mend an algorithm that does not.
    {.n_ticks = 50, .speed_m_per_s = 0.1}};

const Columns<TouchErrors>& jumpColumns() {
  using E = TouchErrors;
  static const Columns<E> kColumns = {{"ticks", &E::ticks},
                                      {"force_jump_max_N", &E::force_jump_max_N},
                                      {"force_jump_concave_max_N", &E::force_jump_concave_max_N},
                                      {"force_mean_N", &E::force_mean_N},
                                      {"missed_ticks", &E::missed_ticks}};
  return kColumns;
}

// Combines the figures of several seeds: the sum of counts, the median of medians, the largest of other figures.
BenchRow together(const std::vector<BenchRow>& seeds) {
  BenchRow all = seeds.front();
  for (std::size_t i = 0; i < all.size(); ++i) {
    auto& [key, figure] = all[i];
    std::vector<double> values;
    std::int64_t sum = 0;
    for (const BenchRow& seed : seeds) {
      const auto* count = std::get_if<std::int64_t>(&seed[i].second);
      if (count != nullptr) sum += *count;
      if (const double value = figureOf(seed, key); !std::isnan(value)) values.push_back(value);
    }
    std::sort(values.begin(), values.end());
    if (std::holds_alternative<std::int64_t>(figure)) {
      figure = sum;
    } else if (!values.empty()) {
      figure = quantile(values, key.find("_median_") != std::string::npos ? 0.5 : 1);
    }
  }
  return all;
}

// NAME_UNIT, NAME_quartile_1_UNIT and NAME_quartile_3_UNIT.
void addSpread(BenchRow& row, const std::string& name, const std::string& unit, std::vector<double> values) {
  const Spread spread = spreadOf(std::move(values));
  row.emplace_back(name + unit, spread.median);
  row.emplace_back(name + "_quartile_1" + unit, spread.low);
  row.emplace_back(name + "_quartile_3" + unit, spread.high);
}

class ServoBench {
 public:
  ServoBench(const ServoBenchRequest& request, Progress& progress)
      : request_(request), progress_(progress), result_(beginBench("servo")) {}

  BenchResult run() {
    for (const std::string& name : request_.volumes) touch(name);
    for (const std::string& name : request_.accuracy_volumes) accuracy(name);
    strokes("shell of 1 voxel", "phantom:shell?size=64&thickness=1", true);
    strokes("shell of 1.2 voxels", "phantom:shell?size=64&thickness=1.2", true);
    strokes("shell of 2 voxels", "phantom:shell?size=64&thickness=2", true);
    strokes("knot", "phantom:knot?size=64", false);
    press(kBall20mm, {1, 4, 12, 24});
    press(kTubeOf8, {1, 4});
    speed(kBall20mm, 4, {0.05, 0.1, 0.25, 0.5, 1, 1.5, 2});  // 2 mm deep both
    speed(kTubeOf8, 2, {0.05, 0.1, 0.25, 0.5});
    for (const std::string& name : request_.volumes) tableOneTrial(name);
    addServoTargets(result_);
    return std::move(result_);
  }

 private:
  // Reports the progress of one step, after `done` of `all` steps.
  [[nodiscard]] BenchProgress step(double done = 0, double all = 1) {
    return [this, done, all](double share) {
      progress_.fraction((done + share) / all);
      throwIfInterrupted("palpate bench servo");
    };
  }

  [[nodiscard]] BenchRow rowOf(const char* part, const std::string& volume, const Entrant& entrant) const {
    return {{"part", part}, {"volume", volume}, {"algorithm", entrant.algorithm}, {"n_ticks", std::int64_t{entrant.n}}};
  }

  // A path under this condition, with its own seed. Empty if the volume is nowhere thick enough and may be thin.
  [[nodiscard]] static std::optional<ContactPath> pathOf(const BenchVolume& volume, const Condition& condition,
                                                         std::size_t ticks, std::uint64_t seed, bool may_be_thin) {
    try {
      return contactPath(volume, {.speed_m_per_s = condition.speed_m_per_s,
                                  .rate_hz = kBenchRate_hz,
                                  .depth_voxel = condition.depth_voxel,
                                  .ticks = ticks,
                                  .seed = seed});
    } catch (const Error&) {
      if (may_be_thin) return std::nullopt;
      throw;
    }
  }

  void run(const Trial& trial) {
    progress_.stage(trial.stage);
    std::vector<Condition> conditions;
    for (const double speed : trial.speeds_m_per_s) {
      for (const double depth : trial.depths_voxel) {
        conditions.push_back({static_cast<std::int64_t>(request_.seed), trial.seeds, trial.noise_voxel, depth, speed});
      }
    }
    std::vector<Entrant> entrants;
    std::vector<std::vector<std::vector<BenchRow>>> errors(conditions.size());  // condition, entrant, seed
    std::vector<std::vector<TickCost>> costs(conditions.size());                // condition, entrant
    for (int i = 0; i < trial.seeds; ++i) {
      const std::uint64_t seed = request_.seed + static_cast<std::uint64_t>(i);
      const BenchVolume volume(withNoise(trial.volume, trial.noise_voxel, seed));
      entrants = trial.entrants(volume);
      for (std::size_t c = 0; c < conditions.size(); ++c) {
        const auto path = pathOf(volume, conditions[c], trial.ticks, seed, trial.may_be_thin);
        if (!path) continue;
        const auto still = step(i * static_cast<double>(conditions.size()) + static_cast<double>(c),
                                trial.seeds * static_cast<double>(conditions.size()));
        errors[c].resize(entrants.size());
        const auto found = touchErrors(volume, *path, entrants, still, trial.miss_depth_voxel);
        for (std::size_t e = 0; e < entrants.size(); ++e) {
          addFigures(errors[c][e].emplace_back(), trial.recovers ? jumpColumns() : errorColumns(), found[e]);
        }
        if (!trial.cost) continue;
        progress_.stage(fmt::format("costs on {}", trial.volume));
        const ReplayPath replay(volume, *pathOf(volume, conditions[c], request_.cost_ticks, seed, false));
        costs[c] = tickCosts(replay, entrants, *trial.cost, still);
      }
    }
    for (std::size_t c = 0; c < conditions.size(); ++c) {
      for (std::size_t e = 0; e < errors[c].size(); ++e) {
        BenchRow& row = result_.rows.emplace_back(rowOf(trial.part, trial.volume, entrants[e]));
        conditions[c].effects = entrants[e].effects;
        addFigures(row, trial.told, conditions[c]);
        if (trial.cost) addCosts(row, costs[c][e], *trial.cost);
        const BenchRow figures = together(errors[c][e]);
        row.insert(row.end(), figures.begin(), figures.end());
      }
      if (trial.cost && trial.cost->tick_replays > 0) addRatios(trial.volume, entrants, costs[c]);
    }
  }

  static void addCosts(BenchRow& row, const TickCost& cost, const CostRequest& request) {
    if (request.tick_replays > 0) {
      addFigures(row, costColumns(), cost);
    } else {
      addSpread(row, "cost", "_ns", cost.batch_ns);
    }
  }

  // The ratio of hri's cost to another's within each repetition, in which both are replayed one after the other.
  void addRatios(const std::string& volume, const std::vector<Entrant>& entrants, const std::vector<TickCost>& costs) {
    const auto hri = std::find_if(entrants.begin(), entrants.end(),
                                  [](const Entrant& e) { return e.algorithm == "hri" && e.n == kTableRenewal; });
    if (hri == entrants.end()) return;
    const std::vector<double>& ours_ns = costs[static_cast<std::size_t>(hri - entrants.begin())].batch_ns;
    for (std::size_t e = 0; e < entrants.size(); ++e) {
      if (entrants[e].n != kTableRenewal || entrants[e].algorithm == "hri") continue;
      std::vector<double> ratios;
      for (std::size_t i = 0; i < ours_ns.size(); ++i) ratios.push_back(ours_ns[i] / costs[e].batch_ns[i]);
      addSpread(result_.rows.emplace_back(rowOf("ratio", volume, entrants[e])), "hri_over_it", "", std::move(ratios));
    }
  }

  // Every algorithm with every n. A note names each algorithm that cannot take part, once for all volumes.
  [[nodiscard]] Who everyone() {
    return [this](const BenchVolume& volume) {
      Entrants entrants = makeEntrants(volume, request_.renewals);
      for (const std::string& words : entrants.left_out) {
        if (noted_.insert(words).second) result_.note("left out: " + words);
      }
      return std::move(entrants.list);
    };
  }

  // Cost and error on one of the paper's volumes.
  void touch(const std::string& name) {
    Trial trial = {"tick", "errors on " + name, name, everyone(), request_.error_ticks, {kTellSeed}};
    trial.cost = CostRequest{request_.repetitions, request_.tick_replays};
    run(trial);
    if (name == request_.volumes.front()) harness(BenchVolume(name));
  }

  void accuracy(const std::string& name) {
    run({"accuracy", "accuracy on " + name, name, everyone(), request_.accuracy_ticks, {kTellSeed}});
    if (name != request_.accuracy_volumes.front()) return;
    for (const auto& [n, speed] : kRecoveryConditions) {
      Trial trial = {
          "effects",      "recovery time on " + name, name,
          withEffects(n), request_.accuracy_ticks,    {kTellEffects, kTellRecovery, kTellSpeed, kTellDepth, kTellSeed}};
      trial.speeds_m_per_s = {speed};
      trial.recovers = true;
      run(trial);
    }
    addRecoveryTargets();
  }

  void press(const std::string& name, const std::vector<double>& depths_voxel) {
    for (const double noise_voxel : {0.0, 0.1, 0.25, 0.5}) {
      Trial trial = {"press",      "noise and depth on " + name, name,
                     once({1, 5}), request_.press_ticks,         {kTellNoise, kTellDepth, kTellSeed, kTellSeeds}};
      trial.depths_voxel = depths_voxel;
      trial.noise_voxel = noise_voxel;
      trial.miss_depth_voxel = missDepth_voxel(noise_voxel);
      trial.seeds = noise_voxel > 0 ? request_.press_seeds : 1;
      run(trial);
    }
  }

  void speed(const std::string& name, double depth_voxel, const std::vector<double>& speeds_m_per_s) {
    run({"speed",
         "speeds on " + name,
         name,
         once({1, 2, 5, 10, 20, 50, 100, 1000}),
         request_.press_ticks,
         {kTellSpeed, kTellDepth, kTellSeed},
         {depth_voxel},
         speeds_m_per_s});
  }

  // Up to half as deep as the knot's tube and the skull are thick.
  void tableOneTrial(const std::string& name) {
    for (const double noise_voxel : {0.0, 0.25}) {
      Trial trial = {"table",
                     "Table 1 with noise and depth on " + name,
                     name,
                     ofTableOne,
                     request_.cost_ticks,
                     {kTellNoise, kTellDepth, kTellSeed}};
      trial.depths_voxel = {1, 2};
      trial.noise_voxel = noise_voxel;
      trial.may_be_thin = true;
      trial.cost = CostRequest{request_.repetitions, 0};
      run(trial);
    }
  }

  // The paper found its discontinuities where the surface is concave along the tool's path (section 4).
  void addRecoveryTargets() {
    const auto& [n, speed] = kRecoveryConditions[0];
    const auto of = [&, n = std::int64_t{n}](const char* effects) {
      return rowsOf(result_, "effects", {{"algorithm", "hri"}, {"effects", effects}, {"n_ticks", n}});
    };
    const BenchRows off = of("none"), on = of(kRecoveryChoice);
    // A short path may meet nothing concave, or touch nothing.
    if (off.empty() || on.empty() || !(figureOf(*off[0], "force_jump_concave_max_N") > 0)) return;
    const auto ratio = [&](const char* key) { return figureOf(*on[0], key) / figureOf(*off[0], key); };
    const std::string where = fmt::format("(hri, knot 128x128x64, n={}, {:g} m/s, 1 voxel deep, {:g} ms) [-]", n, speed,
                                          1e3 * kRecoveryTime_s);
    result_.targets.push_back({"recovery on / off, largest force jump per tick on concave regions " + where,
                               ratio("force_jump_concave_max_N"), 0.1});
    result_.targets.push_back(
        {"recovery on / off, mean force differs by " + where, std::abs(ratio("force_mean_N") - 1), 0.01});
  }

  // Cost of a tick without renewal: the tool trembles by a hundredth of a voxel on the spot, and the plane is kept.
  void harness(const BenchVolume& volume) {
    const auto path = [&](std::size_t ticks) { return *pathOf(volume, {}, ticks, request_.seed, false); };
    ContactPath held = path(1);
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
    BenchRow& row = result_.rows.emplace_back(BenchRow{{"part", "harness"}, {"volume", volume.name()}});
    row.emplace_back("clock_ns", clockCost_ns());
    row.emplace_back("empty_tick_ns", harnessCost_ns(ReplayPath(volume, path(request_.cost_ticks))));
    addSpread(row, "hri_without_renewal", "_ns", std::move(held_ns));
  }

  void strokes(const std::string& wall, const std::string& name, bool thin) {
    progress_.stage("strokes into a " + wall);
    const BenchVolume volume(name);
    Entrants entrants = makeEntrants(volume, {kTableRenewal});
    const auto figures = strokeFigures(volume, {.strokes = request_.strokes, .thin_wall = thin, .seed = request_.seed},
                                       entrants.list, step());
    const Columns<StrokeFigures> columns = {{"wall", [&](const StrokeFigures&) { return wall; }},
                                            {"speed_m_per_s", &StrokeFigures::speed_m_per_s},
                                            {"strokes", &StrokeFigures::strokes},
                                            {"strokes_over_holes_in_samples", &StrokeFigures::over_hole},
                                            {"missed", &StrokeFigures::missed},
                                            {"lost", &StrokeFigures::lost}};
    for (std::size_t e = 0; e < entrants.list.size(); ++e) {
      for (const StrokeFigures& f : figures[e]) {
        BenchRow& row = result_.rows.emplace_back(rowOf("strokes", name, entrants.list[e]));
        row.emplace_back("seed", static_cast<std::int64_t>(request_.seed));
        addFigures(row, columns, f);
      }
    }
  }

  ServoBenchRequest request_;
  Progress& progress_;
  BenchResult result_;
  std::set<std::string> noted_;
};

}  // namespace

BenchResult runServoBench(const ServoBenchRequest& request, Progress& progress) {
  return ServoBench(request, progress).run();
}

}  // namespace palpate
