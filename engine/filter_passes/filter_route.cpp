// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_route.hpp"

namespace palpate {

std::vector<FilterRoute> routesOf(std::span<const FilterStep> steps) {
  std::vector<FilterRoute> routes;
  int from = FilterRoute::kSource;
  constexpr int kNone = -2;
  int kept = kNone;  // the step whose output a distance reads again in its last step
  const auto writes = [&](int step, std::size_t pool) {
    return step >= 0 && routes[static_cast<std::size_t>(step)].pool == pool;
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const auto step = static_cast<int>(i);
    if (steps[i].kind == StepKind::kDistanceFinish) {
      routes.push_back({kept, routes.back().pool, true});
      kept = kNone;
    } else {
      const bool finish_follows = i + 2 == steps.size() && steps[i + 1].kind == StepKind::kDistanceFinish;
      std::size_t pool = i + 1 == steps.size() || finish_follows ? FilterRoute::kResult : 0;
      while (pool != FilterRoute::kResult && (writes(from, pool) || writes(kept, pool))) ++pool;
      if (steps[i].kind == StepKind::kDistanceSeed) kept = from;
      routes.push_back({from, pool, false});
    }
    from = step;
  }
  return routes;
}

}  // namespace palpate
