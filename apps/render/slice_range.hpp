// SPDX-License-Identifier: Apache-2.0
// apps/render/slice_range.hpp: which densities a slice shows black and white when nobody says. Any thread.
#pragma once

#include "apps/render/render_request.hpp"
#include "engine/field/statistics.hpp"

namespace palpate {

// From the density that 0.5 % of the voxels do not exceed to the one that 99.5 % do not exceed, to a bin of the
// histogram: a few voxels of metal make no picture dark. The whole range where these two lie in one bin.
[[nodiscard]] SliceRange sliceRangeFor(const VolumeStatistics& statistics);

}  // namespace palpate
