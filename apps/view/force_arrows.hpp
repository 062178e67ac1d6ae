// SPDX-License-Identifier: Apache-2.0
// apps/view/force_arrows.hpp: which of a run's many forces are drawn as arrows, how long and in which colour.
//
// World frame [m, N]. Any thread. Cost: two passes over the records.
#pragma once

#include <string>
#include <vector>

#include "apps/view/canvas.hpp"
#include "base/vec.hpp"
#include "servo/loop/tick_record.hpp"

namespace palpate {

struct ForceArrow {
  Vec3 hip_W = Vec3::Zero();    // [m]
  Vec3 vhip_W = Vec3::Zero();   // where the arrow begins [m]
  Vec3 force_W = Vec3::Zero();  // [N]
};

struct ForceArrows {
  std::vector<ForceArrow> arrows;
  double every_m = 0;  // of the VHIP's way in contact: 1, 2 or 5 times a power of ten [m]
  double most_N = 0;   // largest force of the run in contact [N]
};

// One arrow for each stretch of the VHIP's way, about `wanted` in all: at its middle, or, where the force there is
// clearly below the stretch's largest, at that largest one, so that a peak is not left out.
[[nodiscard]] ForceArrows chooseForceArrows(const std::vector<TickRecord>& records, int wanted);

// How the arrows stand, for the legend: "an arrow every 2 mm" where neighbours are that far apart, give or take half;
// "11 arrows along the way" where they are not, as when the tool taps here and there.
[[nodiscard]] std::string arrowWords(const ForceArrows& forces);

// From yellow (no force) over red to violet (the largest); share 0..1.
[[nodiscard]] Color forceColor(double share);

// The largest of 1, 2, 5 times a power of ten that is not above `value` (> 0).
[[nodiscard]] double roundDown(double value);

}  // namespace palpate
