// SPDX-License-Identifier: Apache-2.0
// engine/edit/brush_profile.hpp: the density profile across a surface that an edit makes. With it the new surface fits
// those that the volume has already.
//
// The profile is a ramp: density is linear in the distance from the new surface and equals the isovalue on it. Every
// cell that the surface crosses lies inside the linear part of the ramp. So trilinear interpolation puts the isosurface
// where the brush says. What remains is the error of interpolating the distance from a curved surface: h^2 / 8R along
// each axis, with spacing h and radius of curvature R.
// Thread: any.
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

// Whether a brush acts once or again and again in its place, as a tool's does. With a falloff one stroke leaves a part
// of what was there, each further one less of it.
enum class Strokes { kOne, kMany };

// The radius at which an add or a remove at strength 1 puts its surface [m], at most: `radius_m`, less the depth at
// which a fade leaves as much of what was there as it makes (docs/edits.md). That depth is for equal contrasts on both
// sides of the isovalue; the farther the old density is from it, the larger.
[[nodiscard]] double surfaceRadius(const EditCommand& command, const Lattice& lattice, Strokes strokes = Strokes::kOne);

// The share of the volume within surfaceRadius() by which an add or a remove falls short at least, in [0, 1]. The
// trilinear field between voxels is above the distance d from the brush's segment, by h^2 / 12 times the second
// derivative of d on average for each axis of spacing h. On a ball the second derivatives are 2 / 3r on average: the
// surface lies deeper by the sum of h^2 / 18r. On a cylinder along the unit vector t they are (1 - t_axis^2) / 2r.
// Without a falloff good to 0.05 where the radius is no less than the largest spacing, to 0.1 at 0.7 of it; below,
// voxels show a brush by chance.
[[nodiscard]] double brushShortfall(const EditCommand& command, const Lattice& lattice,
                                    Strokes strokes = Strokes::kOne);

// The text of a warning for a brush that is too fine for the voxels: one below half a voxel, or an add or a remove that
// falls short by kToldShortfall. Empty for any other command.
inline constexpr double kToldShortfall = 0.15;
[[nodiscard]] std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice,
                                           Strokes strokes = Strokes::kOne);

}  // namespace palpate
