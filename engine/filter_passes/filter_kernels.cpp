// SPDX-License-Identifier: Apache-2.0
#include "engine/filter_passes/filter_kernels.hpp"

#include <algorithm>

#include "shaders/filter.layout.h"

namespace palpate {
namespace {

std::vector<std::uint32_t> boxReach(const Vec3i& reach) {
  return {static_cast<std::uint32_t>(reach.x()), static_cast<std::uint32_t>(reach.y()),
          static_cast<std::uint32_t>(reach.z())};
}

// The fastest kernel for this reach: it sorts the ranks of small windows and searches those of large ones.
std::string medianKernel(const Vec3i& reach) {
  if (reach.maxCoeff() <= 1) return "filter_median";
  if (reach.x() == 2 && reach.maxCoeff() == 2) return "filter_median_wide";
  return "filter_median_search";
}

}  // namespace

FilterKernel filterKernel(const FilterStep& step) {
  const auto axis = static_cast<std::uint32_t>(step.axis);
  const auto reach = static_cast<std::uint32_t>(step.reach[step.axis]);
  const std::uint32_t bricks_along_line = step.axis == 0 ? 1 : 4;  // 64 rows, or 16 columns, of a brick
  switch (step.kind) {
    case StepKind::kConvolve:
      return {"filter_convolve", bricks_along_line, true, {axis, reach}};
    case StepKind::kBilateral: {
      const auto reaches = step.reach.cast<std::uint32_t>();
      return {"filter_bilateral", 1, true, {reaches.x(), reaches.y(), reaches.z()}};
    }
    case StepKind::kDiffuse:
      return {"filter_diffuse", 1, false, {step.conductance == Conductance::kExp ? 1U : 0U}};
    case StepKind::kDistanceSeed:
      return {"filter_distance_seed", 1, false, {}};
    case StepKind::kDistanceSpread:
      return {"filter_distance_spread", 1, false, {axis, reach}};
    case StepKind::kDistanceFinish:
      return {"filter_distance_finish", 1, false, {}};
    case StepKind::kMedian:
      return {medianKernel(step.reach), 1, true, boxReach(step.reach)};
    case StepKind::kHighestOnLine:
      return {"filter_extreme_line", bricks_along_line, true, {EXTREME_HIGHEST, axis, reach}};
    case StepKind::kLowestOnLine:
      return {"filter_extreme_line", bricks_along_line, true, {EXTREME_LOWEST, axis, reach}};
    case StepKind::kHighestInRows:
      return {"filter_extreme_rows", 1, true, {EXTREME_HIGHEST, static_cast<std::uint32_t>(step.reach.x())}};
    case StepKind::kLowestInRows:
      return {"filter_extreme_rows", 1, true, {EXTREME_LOWEST, static_cast<std::uint32_t>(step.reach.x())}};
  }
  return {};
}

std::vector<float> kernelTaps(const FilterStep& step) {
  if (step.rows.empty()) return step.taps.empty() ? std::vector<float>(1) : step.taps;
  std::vector<float> taps;
  for (int half = 0; half <= step.reach.x() + 1; ++half) {
    taps.push_back(static_cast<float>(
        std::count_if(step.rows.begin(), step.rows.end(), [&](const ShapeRow& row) { return row.half < half; })));
  }
  for (const ShapeRow& row : step.rows) {
    taps.push_back(static_cast<float>(row.dj));
    taps.push_back(static_cast<float>(row.dk));
  }
  return taps;
}

}  // namespace palpate
