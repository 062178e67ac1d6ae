// SPDX-License-Identifier: Apache-2.0
// engine/reference/neighbours.hpp: the six densities around a voxel. Any thread.
#pragma once

#include <algorithm>
#include <array>

#include "base/vec.hpp"

namespace palpate::reference {

// By axis. A neighbour beyond the domain has the voxel's own density.
struct Neighbours {
  std::array<float, 3> before{}, after{};
};

// `density(voxel)` gives a voxel's density.
template <typename Density>
Neighbours neighboursOf(const Vec3i& voxel, const Vec3i& size, const Density& density) {
  Neighbours neighbours;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i before = voxel;
    Vec3i after = voxel;
    before[axis] = std::max(voxel[axis] - 1, 0);
    after[axis] = std::min(voxel[axis] + 1, size[axis] - 1);
    neighbours.before[axis] = density(before);
    neighbours.after[axis] = density(after);
  }
  return neighbours;
}

}  // namespace palpate::reference
