// SPDX-License-Identifier: Apache-2.0
// engine/edit/brush_profile.hpp: the density profile across a surface that an edit makes. With it the new surface fits
// those that the volume has already.
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
  double band_m = 0;       // width of the ramp on either side of the surface [m]
};

// Width of the band in units of the largest spacing [voxel]. It exceeds a cell's diagonal, which is at most sqrt(3).
inline constexpr double kRampVoxels = 2;

// The profile that fits `volume`. Its object density is the mean of the densities above the isovalue. Its background is
// the volume's lowest density. If that equals the isovalue, the background lies as far below the isovalue as the object
// density lies above. Refuses (Error kBadInput) an isovalue outside [minimum, maximum). Cost: one pass over the volume.
[[nodiscard]] BrushProfile brushProfile(const Volume& volume, double isovalue);

// The profile for given densities. The smaller of the two contrasts sets its slope, so the ramp is linear over the band
// on both sides.
[[nodiscard]] BrushProfile brushProfile(double isovalue, double background, double object, const Vec3& spacing_m);

// Slope of the ramp [density/m] at a surface with density `object` inside, which is above the isovalue. It is the
// profile's slope, or less where `object` is too near to the isovalue for that slope to stay linear over the band.
[[nodiscard]] double slopeTowards(const BrushProfile& profile, double object);

// Depth under such a surface at which the ramp ends [m], rising to `object` or falling to the background.
[[nodiscard]] double rampDepth(const BrushProfile& profile, double object);

// The text of a warning for a brush that is too fine for the voxels to show. Empty for any other command.
[[nodiscard]] std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice,
                                           const BrushProfile& profile);

}  // namespace palpate
