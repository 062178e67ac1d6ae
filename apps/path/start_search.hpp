// SPDX-License-Identifier: Apache-2.0
// apps/path/start_search.hpp: chooses where the tool first meets the surface.
//
// World frame [m]. Set-up code, any thread. Cost: at most a few hundred thousand samples.
#pragma once

#include <cstddef>
#include <optional>

#include "apps/path/object_pieces.hpp"

namespace palpate {

// The surface point nearest to a requested start. Refuses (Error kBadInput) a start without a surface near it.
[[nodiscard]] SurfaceHit startNear(const SurfaceField& field, const Vec3& start_W);

// The best place to start on a piece. Rays are cast through and around the middle of the piece's box (along `toward_W`
// if it is given). Of the places where they enter the piece, the best one has the least varying normals around it and
// room in front of it for the approach. If no ray meets a surface that faces it and `toward_W` is empty, short rays
// into samples of the piece are tried. Empty if all miss.
[[nodiscard]] std::optional<SurfaceHit> startOn(const SurfaceField& field, const ObjectPieces& pieces,
                                                std::size_t piece, const std::optional<Vec3>& toward_W,
                                                double approach_m);

}  // namespace palpate
