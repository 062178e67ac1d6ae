// SPDX-License-Identifier: Apache-2.0
// engine/filter/rank_steps.hpp: the steps of filters that pick one value of a neighbourhood: median, dilate, erode,
// open, close. Any thread; called by lowerFilters().
//
// A neighbourhood of radius r holds the voxels whose centres are at most r away. So r = 1 and r = 1.9 voxels both reach
// one voxel, and a length shorter than the spacing reaches none along that axis. A neighbourhood of the middle voxel
// alone yields no step. A median follows FilterSpec::border. The other steps always use Border::kNearest: beyond the
// border both rules only repeat values of the neighbourhood, so its highest and lowest values are the same.
#pragma once

#include <vector>

#include "engine/filter/filter_step.hpp"

namespace palpate {

// Appends the steps of a median. Throws Error(kBadInput) beyond a reach of kLargestMedian voxels.
void lowerMedian(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps);

// Appends the steps of a dilate, erode, open or close. Throws Error(kBadInput) beyond a reach of kLargestReach voxels
// for a box, kLargestBall for a ball.
void lowerMorphology(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps);

}  // namespace palpate
