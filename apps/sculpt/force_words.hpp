// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/force_words.hpp: says what is felt, or why nothing is, and what to do about it. Any thread; no cost.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "servo/devices/device.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct ForceWords {
  std::string state;                 // "0.75 N, 1.5 mm deep", "no contact"
  std::vector<std::string> reasons;  // why there is no force, or less than there would be, each with its remedy
};

// `tick`: the newest; tick -1: the servo has not begun. `missing`: why no servo runs, and what to do; empty: one does.
// Of a device that a person holds, `held`: why it exerts no force, if it does not; empty: a pointer leads the tool.
[[nodiscard]] ForceWords forceWords(const TickRecord& tick, const std::string& missing, double isovalue,
                                    std::optional<ForceOff> held = {});

}  // namespace palpate
