// SPDX-License-Identifier: Apache-2.0
#include "engine/passes/filter_kernels.hpp"

namespace palpate {

FilterKernel filterKernel(const FilterStep& step) {
  const auto axis = static_cast<std::uint32_t>(step.axis);
  const auto reach = static_cast<std::uint32_t>(step.reach[step.axis]);
  const std::uint32_t bricks_along_line = step.axis == 0 ? 1 : 4;  // 64 rows, or 16 columns, of a brick
  switch (step.kind) {
    case StepKind::kConvolve:
      return {"filter_convolve", bricks_along_line, {axis, reach}};
    case StepKind::kBilateral: {
      const auto reaches = step.reach.cast<std::uint32_t>();
      return {"filter_bilateral", 1, {reaches.x(), reaches.y(), reaches.z()}};
    }
    case StepKind::kDiffuse:
      return {"filter_diffuse", 1, {step.conductance == Conductance::kExp ? 1U : 0U}};
    case StepKind::kDistanceSeed:
      return {"filter_distance_seed", 1, {}};
    case StepKind::kDistanceSpread:
      return {"filter_distance_spread", 1, {axis, reach}};
    case StepKind::kDistanceFinish:
      return {"filter_distance_finish", 1, {}};
  }
  return {};
}

}  // namespace palpate
