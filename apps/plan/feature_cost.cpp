// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/feature_cost.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "apps/plan/reasons.hpp"
#include "base/error.hpp"
#include "base/quantile.hpp"
#include "base/stopwatch.hpp"

namespace palpate {
namespace {

// A scene and what its runs found.
struct Trial {
  Scene scene;
  std::vector<RunCounts> runs = {};
  std::string failure = {};
};

template <typename Figure>
std::vector<double> sortedFigures(const Trial& trial, Figure figure) {
  std::vector<double> values;
  for (const RunCounts& run : trial.runs) values.push_back(figure(run));
  std::sort(values.begin(), values.end());
  return values;
}

template <typename Figure>
MeasuredDifference differenceOf(const Trial& with, const Trial& without, Figure figure) {
  const std::vector<double> a = sortedFigures(with, figure);
  const std::vector<double> b = sortedFigures(without, figure);
  return {.value = quantile(a, 0.5) - quantile(b, 0.5), .spread = std::max(a.back() - a.front(), b.back() - b.front())};
}

template <typename Count>
std::int64_t lessOf(const Trial& with, const Trial& without, Count count) {
  return static_cast<std::int64_t>(count(with.runs.back())) - static_cast<std::int64_t>(count(without.runs.back()));
}

// A driver's threads may have the program's name.
std::size_t ownThreads(const RunCounts& run) {
  std::set<std::string> names;
  for (const std::string& thread : run.threads)
    if (!threadReason(thread).empty()) names.insert(thread);
  return names.size();
}

FeatureCost costOf(const Feature& feature, const Trial& scene, const Trial& switched) {
  FeatureCost cost{.feature = &feature, .is_in = feature.is_in(scene.scene), .failure = switched.failure};
  if (!cost.failure.empty()) return cost;
  const Trial& with = cost.is_in ? scene : switched;
  const Trial& without = cost.is_in ? switched : scene;
  cost.start_ms = differenceOf(with, without, [](const RunCounts& run) { return run.start_ms; });
  cost.tick_us = differenceOf(with, without, [](const RunCounts& run) { return run.tick_us; });
  cost.main_bytes =
      differenceOf(with, without, [](const RunCounts& run) { return static_cast<double>(run.main_bytes); });
  cost.gpu_bytes = lessOf(with, without, [](const RunCounts& run) { return run.gpu.peak_bytes; });
  cost.pipelines = lessOf(with, without, [](const RunCounts& run) { return run.gpu.kernels.size(); });
  cost.dispatches =
      differenceOf(with, without, [](const RunCounts& run) { return static_cast<double>(run.dispatches()); });
  cost.effect_runs = lessOf(with, without, [](const RunCounts& run) { return run.effect_runs; });
  cost.threads = lessOf(with, without, ownThreads);
  cost.libraries = lessOf(with, without, [](const RunCounts& run) { return run.libraries.size(); });
  return cost;
}

// A scene that is refused with a feature switched is no reason to say nothing of the others.
void runTrial(Trial& trial, bool must_run, const std::filesystem::path& folder, const std::string& program) {
  if (!trial.failure.empty()) return;
  try {
    trial.runs.push_back(countedRun(trial.scene, folder, program));
  } catch (const Error& error) {
    if (must_run || error.code() == Error::Code::kCancelled || error.code() == Error::Code::kIo) throw;
    trial.failure = error.reason();
  }
}

// What is switched, and from which scene.
struct Switched {
  const Feature* feature = nullptr;
  std::size_t from = 0, to = 0;  // of the list of trials
};

}  // namespace

SceneCounts countScene(const Scene& scene, int rounds, const std::filesystem::path& folder, Progress& progress,
                       const std::string& program) {
  std::vector<Trial> trials = {{.scene = scene}};
  std::vector<Switched> switches;
  if (rounds > 0) {
    // A picture takes longer to draw than all else in so short a run. So other features are switched without it.
    if (scene.picture) {
      trials.push_back({.scene = scene});
      trials.back().scene.picture = false;
    }
    const std::size_t ground = trials.size() - 1;
    for (const Feature& feature : features()) {
      const bool takes_picture = scene.picture && feature.is_in(scene) && !feature.is_in(trials[ground].scene);
      if (takes_picture) {
        switches.push_back({&feature, 0, ground});
        continue;
      }
      Scene other = trials[ground].scene;
      feature.is_in(other) ? feature.remove(other) : feature.add(other, folder);
      switches.push_back({&feature, ground, trials.size()});
      trials.push_back({.scene = std::move(other)});
    }
  }
  progress.stage(rounds > 0 ? "running the scene with and without each feature" : "running the scene");
  const Stopwatch watch;
  const std::size_t all = trials.size() * static_cast<std::size_t>(std::max(1, rounds));
  for (std::size_t n = 0; n < all; ++n) {
    const std::size_t which = n % trials.size();
    const bool must_run = which == 0 || (!switches.empty() && which == switches.front().from);
    runTrial(trials[which], must_run, folder, program);
    const double done = static_cast<double>(n + 1) / static_cast<double>(all);
    progress.fraction(done, watch.seconds() * (1 - done) / done);
  }
  SceneCounts counts{.counts = trials.front().runs.back(), .costs = {}};
  for (const Switched& one : switches) counts.costs.push_back(costOf(*one.feature, trials[one.from], trials[one.to]));
  return counts;
}

}  // namespace palpate
