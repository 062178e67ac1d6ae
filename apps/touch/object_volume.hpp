// SPDX-License-Identifier: Apache-2.0
// apps/touch/object_volume.hpp: how much of a volume is object, to say what a run's edits took away or added.
#pragma once

#include "engine/volume/volume.hpp"

namespace palpate {

// Voxels above the isovalue times a voxel's volume [m^3]. A voxel at the surface counts whole or not at all, so a
// smooth surface's errors cancel out, and the difference of two volumes is exact to about the square root of the number
// of voxels that the surface between them meets. Any thread. Cost: one pass over the bricks.
[[nodiscard]] double objectVolume_m3(const Volume& volume, double isovalue);

}  // namespace palpate
