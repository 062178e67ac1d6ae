// SPDX-License-Identifier: Apache-2.0
// apps/touch/plane_age.hpp: is a plane kept for too long for this path?
//
// A plane that is kept while the tool moves along a curved surface is off in depth, and the force by K times that. How
// far, the algorithm says (servo/algorithms/plane_age.hpp). The curvature is that of the density's level set under the
// tool, along its way, over a voxel to each side.
// Frame W [m]. Set-up code; some microseconds for each of kPlaces.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "apps/path/surface_field.hpp"
#include "apps/scene/scene.hpp"
#include "servo/devices/path.hpp"

namespace palpate {

// The depth error that 90 % of the path's places within the object stay below [m]; 0 if there are none.
inline constexpr int kPlaces = 500;
[[nodiscard]] double planeAgeError(const Path& path, const SurfaceField& surface, std::string_view algorithm, int n,
                                   double rate_hz);

// A note if that error changes the force by kFeltStep_N (run_notes.hpp) or more, with the n that would not. Empty for
// an algorithm that renews no planes.
[[nodiscard]] std::optional<std::string> noteOnPlaneAge(const Scene& scene, const Path& path,
                                                        const SurfaceField& surface);

}  // namespace palpate
