// SPDX-License-Identifier: Apache-2.0
// apps/render/asked_style.hpp: what a request asks of a picture, for a volume: its style, and what its clip planes
// leave of the volume's box. Set-up code, any thread. Cost: microseconds.
#pragma once

#include <span>
#include <vector>

#include "apps/render/render_request.hpp"
#include "base/lattice.hpp"
#include "engine/draw/draw_style.hpp"

namespace palpate {

// `size`: of the volume [voxel], which gives shares of its extent their places. The densities of slices stay as they
// are in DrawStyle where the request has none. Throws Error(kBadInput), which names the flag, for a slice plane beside
// the volume, and for clip planes that leave nothing of it.
[[nodiscard]] DrawStyle styleOf(const RenderRequest& request, const Lattice& lattice, const Vec3i& size);

// The corners of what the planes leave of the box from the centres of the first to those of the last voxels. World [m].
// Some may come twice. Empty: nothing is left, or no more than a face.
[[nodiscard]] std::vector<Vec3> clippedCorners(const Lattice& lattice, const Vec3i& size,
                                               std::span<const ViewPlane> clips);

}  // namespace palpate
