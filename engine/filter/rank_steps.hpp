// SPDX-License-Identifier: Apache-2.0
// engine/filter/rank_steps.hpp: the steps of filters that pick one value of a window: median, dilate, erode, open,
// close. Any thread; called by lowerFilters.
//
// A window of radius r holds the voxels whose centres are at most r away: r = 1 voxel or 1.9 voxels reach one voxel,
// and a length shorter than the spacing reaches none along that axis. A window of the middle voxel alone gives no step.
// A window cut off at the border has the same highest and lowest value as one continued by either border rule, because
// both show there only what the cut window holds already: these steps know Border::kNearest alone.
#pragma once

#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

// Throws Error(kBadInput) beyond kLargestMedian voxels.
void lowerMedian(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps);

// Throws Error(kBadInput) beyond kLargestReach voxels for a box, kLargestBall for a ball.
void lowerMorphology(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps);

}  // namespace palpate
