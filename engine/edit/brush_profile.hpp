// SPDX-License-Identifier: Apache-2.0
// engine/edit/brush_profile.hpp: what surfaces that edits make look like in density, so that they fit the volume.
//
// A new surface is a ramp, linear in the distance from it, that crosses the isovalue exactly there. The ramp is so wide
// that every cell which the surface crosses lies inside its linear part: trilinear interpolation then puts the
// isosurface where the brush says, but for the sag of a curved distance (h^2 / 8R an axis). Thread: any.
#pragma once

#include <string>

#include "engine/edit/edit_command.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

struct BrushProfile {
  double isovalue = 0;     // [density]
  double background = 0;   // where an object was removed [density]; below the isovalue
  double object = 0;       // of what is added [density]; above it
  double slope_per_m = 0;  // of the ramp [density/m]
  double band_m = 0;       // from the surface, into what the edit leaves alone: there the ramp ends [m]
};

inline constexpr double kRampVoxels = 2;  // band, in the largest spacing: more than a cell's diagonal, sqrt(3)

// Background: the volume's lowest density. Object: the mean of what lies above the isovalue. Refuses (Error kBadInput)
// an isovalue outside [minimum, maximum). Cost: one pass.
[[nodiscard]] BrushProfile brushProfile(const Volume& volume, double isovalue);

// The ramp for given densities; the flatter side decides, so that it is linear over the band on both.
[[nodiscard]] BrushProfile brushProfile(double isovalue, double background, double object, const Vec3& spacing_m);

// The ramp of a surface that has `object` inside, above the isovalue [density/m]: flatter than the profile's where that
// is nearer to the isovalue than the profile's own.
[[nodiscard]] double slopeTowards(const BrushProfile& profile, double object);

// How far under such a surface the ramp ends, whether it rises to `object` or falls to the background [m].
[[nodiscard]] double rampDepth(const BrushProfile& profile, double object);

// What a user should know of a brush so fine that voxels cannot show it: words; empty for any other command.
[[nodiscard]] std::string fineBrushWords(const EditCommand& command, const Lattice& lattice,
                                         const BrushProfile& profile);

}  // namespace palpate
