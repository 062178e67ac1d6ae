// SPDX-License-Identifier: Apache-2.0
// apps/touch/object_volume.hpp: how much of a volume is object, to report how much a run's edits removed or added.
#pragma once

#include "engine/field/volume.hpp"

namespace palpate {

// The number of voxels above the isovalue times a voxel's volume [m^3]. A voxel at the surface counts whole or not at
// all; along a smooth surface these errors cancel. So the difference of two volumes is exact to about the square root
// of the number of voxels at the surface between them, in voxels. Any thread. Cost: one pass over the bricks.
[[nodiscard]] double objectVolume_m3(const Volume& volume, double isovalue);

}  // namespace palpate
