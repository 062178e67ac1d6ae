// SPDX-License-Identifier: Apache-2.0
// engine/reference/edited_density.hpp: what docs/edits.md defines, for one voxel at a time. It is written from that
// page and apart from the kernels' text (shaders/edit*.math.glsl), in the page's order of operations, so that bits can
// be compared. Any thread. Cost: some 10 ns.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "base/vec.hpp"
#include "shaders/edit.layout.h"

namespace palpate::reference {

// The six densities around a voxel, by axis. A neighbour beyond the domain has the voxel's own density.
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

// Whether the new density depends on those around the voxel.
[[nodiscard]] bool readsNeighbours(const layout::EditCommand& command) noexcept;

// The density of `voxel` after a command; `f`: before. `around` counts if the command reads it. `stamps`: the distances
// of all stamps (LoweredEdits::stamps).
[[nodiscard]] float editedDensity(const layout::EditCommand& command, const layout::EditScale& scale,
                                  std::span<const float> stamps, const Vec3i& voxel, float f,
                                  const Neighbours& around) noexcept;

}  // namespace palpate::reference
