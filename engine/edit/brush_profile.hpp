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

// Whether a brush acts once or again and again in its place, as a tool's does. With a falloff each stroke leaves a part
// of what was there, and many leave nothing of it.
enum class Strokes { kOne, kMany };

// The radius at which an add or a remove at strength 1 is to have its surface [m]: `radius_m`, or for one stroke with a
// falloff less by the depth at which the fade leaves as much of what was there as it makes (docs/edits.md). For a
// density before that is as far from the isovalue as the one after; for a nearer one it lies less deep, for a farther
// one deeper.
[[nodiscard]] double surfaceRadius(const EditCommand& command, const Lattice& lattice, Strokes strokes = Strokes::kOne);

// The share of the volume within surfaceRadius() by which an add or a remove falls short, in [0, 1], on average over
// places between voxels, which blur the density: brush_profile.cpp says how. Good to 0.05 without a falloff, and to
// 0.12 with one, where that radius is no less than the largest spacing, to 0.1 at 0.7 of it; below, voxels show a brush
// by chance. Cost: 0.1 us without a falloff, some 10 us with one.
[[nodiscard]] double brushShortfall(const EditCommand& command, const Lattice& lattice,
                                    Strokes strokes = Strokes::kOne);

// The text of a warning for a brush that is too fine for the voxels: one below half a voxel, or an add or a remove that
// falls short by a share of `told`. Empty for any other command.
inline constexpr double kToldShortfall = 0.15;
[[nodiscard]] std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice,
                                           Strokes strokes = Strokes::kOne, double told = kToldShortfall);

}  // namespace palpate
