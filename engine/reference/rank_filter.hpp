// SPDX-License-Identifier: Apache-2.0
// engine/reference/rank_filter.hpp: the CPU twin of the filter steps that pick one value of a neighbourhood: the
// median, the highest or the lowest. It orders all values of the neighbourhood, -0 before +0. Slow and obvious; any
// thread.
#pragma once

#include "engine/filter/filter_step.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// The result of a median, highest or lowest step at a voxel.
[[nodiscard]] float picked(const DenseField& field, const Vec3i& voxel, const FilterStep& step);

}  // namespace palpate::reference
