// SPDX-License-Identifier: Apache-2.0
// engine/filter_passes/filter_route.hpp: which pool each step of a chain reads and writes. A step writes a pool that no
// later step still has to read. Two scratch pools suffice for most chains. A distance needs three, since its last step
// reads the densities again that its first step read. The chain's last step writes the result. Any thread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

struct FilterRoute {
  static constexpr int kSource = -1;
  static constexpr std::size_t kResult = 3;  // pools 0 to 2 are scratch
  int from = kSource;                        // the step whose output this one reads
  std::size_t pool = kResult;                // the pool that it writes
  bool in_place = false;                     // it rewrites the output of the step before it
};

[[nodiscard]] std::vector<FilterRoute> routesOf(std::span<const FilterStep> steps);

}  // namespace palpate
