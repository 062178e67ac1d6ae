// SPDX-License-Identifier: Apache-2.0
// apps/plan/scene_report.hpp: what `palpate plan` says of a scene: passes, pipelines, buffers, threads, effects and
// libraries, each with why it is there; and of each feature what it costs, or what leaving it out saves. Any thread; no
// cost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/plan/feature_cost.hpp"
#include "apps/plan/module_cost.hpp"
#include "engine/plan/plan.hpp"

namespace palpate {

struct SceneReport {
  std::string volume = {};
  double isovalue = 0;   // [density]
  std::string gpu = {};  // name of the Vulkan device
  std::vector<PlanLine> lines = {};
  std::vector<StageTime> passes = {};  // of the engine's start
  std::string effects = {};            // names of contact effects; empty: none
  std::vector<ModuleCost> modules = {};
  std::optional<SceneCounts> counted = {};  // empty: no run was counted,
  std::string not_counted = {};             // and this is why
};

// Text with Markdown tables, for printDocument().
[[nodiscard]] std::string reportDocument(const SceneReport& report);
[[nodiscard]] std::string reportJson(const SceneReport& report);

}  // namespace palpate
