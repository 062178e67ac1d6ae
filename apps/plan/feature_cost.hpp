// SPDX-License-Identifier: Apache-2.0
// apps/plan/feature_cost.hpp: what each feature of a scene costs, and what leaving each other one out saves: the scene
// is run as it is and once more with each feature switched, in turns, each run in a process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/plan/counted_run.hpp"
#include "apps/plan/feature.hpp"
#include "apps/scene/scene.hpp"

namespace palpate {

// A difference of medians, and how far the runs of one and the same scene lay apart; NaN if each was run only once.
struct MeasuredDifference {
  double value = 0, spread = 0;
  [[nodiscard]] bool isClear() const noexcept { return value > spread || value < -spread; }
};

// The run with the feature less the run without it.
struct FeatureCost {
  const Feature* feature = nullptr;
  bool is_in = false;                // the scene has it
  std::string failure = {};          // why the scene does not run with it switched, in words; empty: it does
  MeasuredDifference start_ms = {};  // until the first tick
  MeasuredDifference tick_us = {};
  MeasuredDifference main_bytes = {};
  MeasuredDifference dispatches = {};  // how many windows are gathered depends on when the tool is looked at
  std::int64_t gpu_bytes = 0;          // of the most that the device holds at one time; what fits under the peak adds 0
  std::int64_t pipelines = 0, effect_runs = 0, libraries = 0;
  std::int64_t threads = 0;  // of Palpate's own
};

struct SceneCounts {
  RunCounts counts = {};  // of the scene as it is, in its first run
  int rounds = 0;         // how often it was run with each feature switched
  std::vector<FeatureCost> costs = {};
};

// How many rounds over so many scenes fit into a time, if a run takes `run_s`: at most three; none if fewer than two
// do, since one tells no difference from chance. Any thread; no cost.
[[nodiscard]] int roundsIn(double seconds, double run_s, std::size_t scenes) noexcept;

// `rounds`: how often the scene is run with each feature switched; 0: it is run once, as it is; empty: as many as fit
// into a minute. Throws Error as countedRun() does for the scene as it is. A feature with which it fails is told.
[[nodiscard]] SceneCounts countScene(const Scene& scene, std::optional<int> rounds, const std::filesystem::path& folder,
                                     Progress& progress, const std::string& program = {});

}  // namespace palpate
