// SPDX-License-Identifier: Apache-2.0
// engine/passes/filter_route.hpp: which pool each step of a chain reads and writes. A step writes a pool that no one
// reads any more: two scratch pools do for most chains, three while a distance keeps the densities that it began with
// for its end. The last step writes the result. Any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

struct FilterRoute {
  static constexpr int kSource = -1;
  static constexpr std::size_t kResult = 3;  // 0 to 2: scratch
  int from = kSource;                        // the step whose output this one reads
  std::size_t pool = kResult;                // that it writes
  bool in_place = false;                     // what the step before it wrote is changed where it lies
};

[[nodiscard]] std::vector<FilterRoute> routesOf(std::span<const FilterStep> steps);

}  // namespace palpate
