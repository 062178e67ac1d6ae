// SPDX-License-Identifier: Apache-2.0
// apps/plan/feature_cost.hpp: what each feature of a scene costs, and what leaving each other one out saves: the scene
// is run as it is and once more with each feature switched, in turns, each run in a process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/console/progress.hpp"
#include "apps/plan/counted_run.hpp"
#include "apps/plan/feature.hpp"
#include "apps/scene/scene.hpp"

namespace palpate {

// A difference of medians, and how far the runs of one and the same scene lay apart.
struct MeasuredDifference {
  double value = 0, spread = 0;
  [[nodiscard]] bool isClear() const noexcept { return value > spread || value < -spread; }
};

// The run with the feature less the run without it.
struct FeatureCost {
  const Feature* feature = nullptr;
  bool is_in = false;          // the scene has it
  std::string failure = {};         // why the scene does not run with it switched, in words; empty: it does
  MeasuredDifference start_ms = {}; // until the first tick
  MeasuredDifference tick_us = {};
  MeasuredDifference main_bytes = {};
  MeasuredDifference dispatches = {};  // how many windows are gathered depends on when the tool is looked at
  std::int64_t gpu_bytes = 0;  // the most that is held at one time
  std::int64_t pipelines = 0, effect_runs = 0, libraries = 0;
  std::int64_t threads = 0;  // of Palpate's own (reasons.hpp)
};

struct SceneCounts {
  RunCounts counts = {};  // of the scene as it is, in its last run
  std::vector<FeatureCost> costs = {};
};

// `rounds`: runs of each; 0: the scene is run once, and no feature is switched. Throws Error as countedRun() does for
// the scene as it is.
[[nodiscard]] SceneCounts countScene(const Scene& scene, int rounds, const std::filesystem::path& folder,
                                     Progress& progress, const std::string& program = {});

}  // namespace palpate
