// SPDX-License-Identifier: Apache-2.0
// engine/reference/edited_density.hpp: what docs/edits.md defines, for one voxel at a time. It is written from that
// page and apart from the kernels' text (shaders/edit*.math.glsl), in the page's order of operations, so that bits can
// be compared. Any thread. Cost: some 10 ns.
#pragma once

#include <span>

#include "base/vec.hpp"
#include "engine/reference/neighbours.hpp"
#include "shaders/edit.layout.h"

namespace palpate::reference {

// Whether the new density depends on those around the voxel.
[[nodiscard]] bool readsNeighbours(const layout::EditCommand& command) noexcept;

// The density of `voxel` after a command; `f`: before. `around` counts if the command reads it. `stamps`: the distances
// of all stamps (LoweredEdits::stamps).
[[nodiscard]] float editedDensity(const layout::EditCommand& command, const layout::EditScale& scale,
                                  std::span<const float> stamps, const Vec3i& voxel, float f,
                                  const Neighbours& around) noexcept;

}  // namespace palpate::reference
