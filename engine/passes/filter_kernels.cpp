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
  }
  return {};
}

}  // namespace palpate
