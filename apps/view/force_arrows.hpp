// SPDX-License-Identifier: Apache-2.0
// apps/view/force_arrows.hpp: chooses the forces of a run that are drawn as arrows, and their colours.
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
  double every_m = 0;  // spacing along the VHIP's path in contact: 1, 2 or 5 times a power of ten [m]
  double most_N = 0;   // largest force in contact of the run [N]
};

// One arrow for each stretch of the VHIP's path, about `wanted` in all. It stands at the middle of the stretch or, if
// the force there is clearly below the largest of the stretch, at the largest, so that no peak is missed.
[[nodiscard]] ForceArrows chooseForceArrows(const std::vector<TickRecord>& records, int wanted);

// The arrows in words, for the legend: "an arrow every 2 mm" if neighbours are that far apart, within a half; else "11
// arrows along the way", as for a tool that taps here and there.
[[nodiscard]] std::string arrowWords(const ForceArrows& forces);

// From yellow (no force) over red to violet (the largest); share 0..1.
[[nodiscard]] Color forceColor(double share);

// The largest of 1, 2, 5 times a power of ten that is not above `value` (> 0).
[[nodiscard]] double roundDown(double value);

}  // namespace palpate
