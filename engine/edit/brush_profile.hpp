// SPDX-License-Identifier: Apache-2.0
// engine/edit/brush_profile.hpp: the density profile across a surface that an edit makes, so that it fits the volume.
//
// The profile is a ramp: density is linear in the distance from the new surface and equals the isovalue on it. Every
// cell that the surface crosses lies inside the linear part of the ramp. So trilinear interpolation puts the isosurface
// where the brush says. What remains is the error of interpolating the distance from a curved surface: h^2 / 8R along
// each axis, with spacing h and radius of curvature R. Thread: any.
#pragma once

#include <string>

#include "engine/edit/edit_command.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

struct BrushProfile {
  double isovalue = 0;     // [density]
  double background = 0;   // density where object was removed, below the isovalue [density]
  double object = 0;       // density of what is added, above the isovalue [density]
  double slope_per_m = 0;  // of the ramp [density/m]
  double band_m = 0;       // how far the ramp goes on beyond the surface, into what the brush does not cover [m]
};

// The band in units of the largest spacing [voxel]: more than a cell's diagonal, which is at most sqrt(3).
inline constexpr double kRampVoxels = 2;

// Background: the volume's lowest density; where that is the isovalue itself, as far below it as `object` is above.
// Object: the mean of the densities above the isovalue. Refuses (Error kBadInput) an isovalue outside
// [minimum, maximum). Cost: one pass over the volume.
[[nodiscard]] BrushProfile brushProfile(const Volume& volume, double isovalue);

// The profile for given densities. Its slope is that of the side with the smaller contrast, so that the ramp is linear
// over the band on both sides.
[[nodiscard]] BrushProfile brushProfile(double isovalue, double background, double object, const Vec3& spacing_m);

// Slope of the ramp [density/m] at a surface with density `object` inside, which is above the isovalue. It is the
// profile's slope, or less where `object` is too near to the isovalue for that slope to stay linear over the band.
[[nodiscard]] double slopeTowards(const BrushProfile& profile, double object);

// Depth under such a surface at which the ramp has ended, whether it rises to `object` or falls to the background [m].
[[nodiscard]] double rampDepth(const BrushProfile& profile, double object);

// A warning, in words, for a brush so fine that voxels cannot show it. Empty for any other command.
[[nodiscard]] std::string fineBrushWords(const EditCommand& command, const Lattice& lattice,
                                         const BrushProfile& profile);

}  // namespace palpate
