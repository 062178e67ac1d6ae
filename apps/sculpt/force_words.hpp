// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/force_words.hpp: says what is felt, or why nothing is, and what to do about it. Any thread; no cost.
#pragma once

#include <string>
#include <vector>

#include "servo/loop/tick_record.hpp"

namespace palpate {

struct ForceWords {
  std::string state;                 // "0.75 N, 1.5 mm deep", "no contact"
  std::vector<std::string> reasons;  // why there is no force, or less than there would be, each with its remedy
};

// `tick`: the newest; tick -1: the servo has not begun. `runs`: whether the servo does. `held`:
// whether a person holds the device; else a pointer leads it.
[[nodiscard]] ForceWords forceWords(const TickRecord& tick, bool runs, double isovalue, bool held = false);

}  // namespace palpate
