// SPDX-License-Identifier: Apache-2.0
// apps/onlook/seen_volume.hpp: what a window has to know of a volume to show it. Values; any thread.
#pragma once

#include <string>

#include "apps/render/fit_camera.hpp"
#include "base/lattice.hpp"
#include "engine/field/statistics.hpp"

namespace palpate {

struct SeenVolume {
  std::string name;  // as it was loaded
  Vec3i size = Vec3i::Zero();
  Lattice lattice;
  VolumeStatistics statistics;
  SeenExtent object;  // at the first isovalue
};

// The extent with `most` of its points at most: those that reach furthest in directions all over the sphere. Seen from
// anywhere, less than a hundredth of the object's radius is lost for 1000 points. Cost: 4 times points times `most`.
[[nodiscard]] SeenExtent withFewerPoints(const SeenExtent& extent, std::size_t most);

}  // namespace palpate
