// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/feature_cost.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

// A scene and what its runs found.
struct CountedScene {
  Scene scene;
  std::vector<RunCounts> runs = {};
  std::string failure = {};
};

template <typename Figure>
std::vector<double> sortedFigures(const CountedScene& trial, Figure figure) {
  std::vector<double> values;
  for (const RunCounts& run : trial.runs) values.push_back(figure(run));
  std::sort(values.begin(), values.end());
  return values;
}

template <typename Figure>
MeasuredDifference differenceOf(const CountedScene& with, const CountedScene& without, Figure figure) {
  const std::vector<double> a = sortedFigures(with, figure);
  const std::vector<double> b = sortedFigures(without, figure);
  const bool is_known = a.size() > 1 && b.size() > 1;
  return {.value = quantile(a, 0.5) - quantile(b, 0.5),
          .spread = is_known ? std::max(a.back() - a.front(), b.back() - b.front())
                             : std::numeric_limits<double>::quiet_NaN()};
}

template <typename Count>
std::int64_t lessOf(const CountedScene& with, const CountedScene& without, Count count) {
  return static_cast<std::int64_t>(count(with.runs.back())) - static_cast<std::int64_t>(count(without.runs.back()));
}

FeatureCost costOf(const Feature& feature, const CountedScene& scene, const CountedScene& switched) {
  FeatureCost cost{.feature = &feature, .is_in = feature.is_in(scene.scene), .failure = switched.failure};
  if (!cost.failure.empty()) return cost;
  const CountedScene& with = cost.is_in ? scene : switched;
  const CountedScene& without = cost.is_in ? switched : scene;
  cost.start_ms = differenceOf(with, without, [](const RunCounts& run) { return run.start_ms; });
  cost.tick_us = differenceOf(with, without, [](const RunCounts& run) { return run.tick_us; });
  cost.main_bytes =
      differenceOf(with, without, [](const RunCounts& run) { return static_cast<double>(run.main_bytes); });
  cost.gpu_bytes = lessOf(with, without, [](const RunCounts& run) { return run.gpu.peak_bytes; });
  cost.pipelines = lessOf(with, without, [](const RunCounts& run) { return run.gpu.kernels.size(); });
  cost.dispatches =
      differenceOf(with, without, [](const RunCounts& run) { return static_cast<double>(run.dispatches()); });
  cost.effect_runs = lessOf(with, without, [](const RunCounts& run) { return run.effect_runs; });
  cost.threads = lessOf(with, without, [](const RunCounts& run) { return run.ownThreads(); });
  cost.libraries = lessOf(with, without, [](const RunCounts& run) { return run.libraries.size(); });
  return cost;
}

// A scene that is refused with a feature switched is no reason to say nothing of the others.
void runCounted(CountedScene& trial, bool must_run, const std::filesystem::path& folder, const std::string& program) {
  if (!trial.failure.empty()) return;
  try {
    trial.runs.push_back(countedRun(trial.scene, folder, program));
  } catch (const Error& error) {
    if (must_run || error.code() == Error::Code::kCancelled) throw;
    trial.failure = error.reason();
  }
}

// What is switched, and from which scene.
struct Switched {
  const Feature* feature = nullptr;
  std::size_t from = 0, to = 0;  // of the list of scenes
};

constexpr int kUsualRounds = 3;
constexpr double kPatience_s = 60;  // that features may take to be measured if the user gave no number of rounds [s]

}  // namespace

int roundsIn(double seconds, double run_s, std::size_t scenes) noexcept {
  const double rounds = seconds / (run_s * static_cast<double>(scenes));
  return rounds < 2 ? 0 : std::min(kUsualRounds, static_cast<int>(rounds));
}

SceneCounts countScene(const Scene& scene, std::optional<int> rounds, const std::filesystem::path& folder,
                       Progress& progress, const std::string& program) {
  progress.stage("running the scene");
  SceneCounts counts{.counts = countedRun(scene, folder, program)};
  counts.rounds = rounds.value_or(roundsIn(kPatience_s, 1e-3 * counts.counts.wall_ms, features().size() + 2));
  if (counts.rounds == 0) return counts;
  std::vector<CountedScene> scenes = {{.scene = scene}};
  std::vector<Switched> switches;
  // A picture takes longer to draw than all else in so short a run. So other features are switched without it.
  if (scene.picture) {
    scenes.push_back({.scene = scene});
    scenes.back().scene.picture = false;
  }
  const std::size_t ground = scenes.size() - 1;
  for (const Feature& feature : features()) {
    if (feature.is_in(scene) && !feature.is_in(scenes[ground].scene)) {  // the picture
      switches.push_back({&feature, 0, ground});
      continue;
    }
    Scene other = scenes[ground].scene;
    feature.is_in(other) ? feature.remove(other) : feature.add(other, folder);
    switches.push_back({&feature, ground, scenes.size()});
    scenes.push_back({.scene = std::move(other)});
  }
  progress.stage("running the scene with and without each feature");
  const Stopwatch watch;
  const std::size_t all = scenes.size() * static_cast<std::size_t>(counts.rounds);
  for (std::size_t n = 0; n < all; ++n) {
    const std::size_t which = n % scenes.size();
    runCounted(scenes[which], which <= ground, folder, program);
    const double done = static_cast<double>(n + 1) / static_cast<double>(all);
    progress.fraction(done, watch.seconds() * (1 - done) / done);
  }
  for (const Switched& one : switches) counts.costs.push_back(costOf(*one.feature, scenes[one.from], scenes[one.to]));
  return counts;
}

}  // namespace palpate
