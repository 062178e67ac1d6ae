// SPDX-License-Identifier: Apache-2.0
// apps/path/start_search.hpp: chooses where the tool first meets the surface.
//
// World frame [m]. Set-up code, any thread. Cost: at most a few hundred thousand samples.
#pragma once

#include "apps/path/path_request.hpp"
#include "apps/path/surface_search.hpp"

namespace palpate {

// With a wished start: the surface point nearest to it. Otherwise rays are cast from outside the volume through and
// around its middle (along `toward` if it is given), and of the places where they enter the object the one is taken
// whose surroundings have the calmest normals. Refuses (Error kBadInput): no surface near the start, no ray meets the
// surface.
[[nodiscard]] SurfaceHit chooseStart(const SurfaceField& field, const PathRequest& request);

}  // namespace palpate
