// SPDX-License-Identifier: Apache-2.0
// engine/reference/rank_filter.hpp: the CPU twin of the steps that pick one value of a window: all values of the window
// in a list, and the one that stands in its place in order, -0 before +0. Slow and obvious; any thread.
#pragma once

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// What a median or an extreme step gives at a voxel.
[[nodiscard]] float picked(const DenseField& field, const Vec3i& voxel, const FilterStep& step);

}  // namespace palpate::reference
