// SPDX-License-Identifier: Apache-2.0
// apps/path/start_search.hpp: chooses where the tool first meets the surface.
//
// World frame [m]. Set-up code, any thread. Cost: at most a few hundred thousand samples.
#pragma once

#include <cstddef>
#include <optional>

#include "apps/path/object_pieces.hpp"

namespace palpate {

// The surface point nearest to a wished start. Refuses (Error kBadInput): no surface near it.
[[nodiscard]] SurfaceHit startNear(const SurfaceField& field, const Vec3& start_W);

// Rays are cast through and around the middle of the box around a piece (along `toward` if it is given), and of the
// places where they enter the piece the one is taken whose surroundings have the calmest normals, and which has room in
// front of it for the approach. Empty where they meet none that faces them.
[[nodiscard]] std::optional<SurfaceHit> startOn(const SurfaceField& field, const ObjectPieces& pieces,
                                                std::size_t piece, const std::optional<Vec3>& toward_W,
                                                double approach_m);

}  // namespace palpate
