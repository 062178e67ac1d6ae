// SPDX-License-Identifier: Apache-2.0
// apps/path/path_fit.hpp: how deep, how long and from how far a path is where nobody says: as fits the object.
//
// World frame [m]. Set-up code, any thread while the field does not change.
#pragma once

#include "apps/path/object_pieces.hpp"
#include "apps/path/surface_march.hpp"

namespace palpate {

// A finger's: 10 mm of approach, 1 mm of depth, 20 mm of slide, where the object is as large as what a finger feels,
// from 3 to 40 cm. A smaller one gets less of each, a larger one more, in proportion to its size. Samples the size of a
// large part of it need their own room: never below two of the smallest spacing outside, and a twentieth of it deep. A
// press is never above 4 mm, which a wall of usual stiffness answers with 2 N.
struct PathFit {
  double approach_m = 0;
  double slide_m = 0;
  double most_depth_m = 0;  // on a thick object
};

// `size_m`: the longest edge of the box around the piece that is touched; `voxel_m`: the smallest spacing.
[[nodiscard]] PathFit fitTo(double size_m, double voxel_m);

// The longest edge of the box around a piece, half a sample more on each side [m].
[[nodiscard]] double sizeOf(const ObjectPiece& piece, const Lattice& lattice);

// How much object is under a surface point, against its normal, at most `reach_m`: what lies beyond the volume counts
// as object. Steps of an eighth of a voxel or a sixteenth of the reach.
[[nodiscard]] double thicknessAt(const SurfaceField& field, const SurfaceHit& at, double reach_m);

// A quarter of how thick the object is along the curve, so that the nearest surface is the one that was pressed; less
// where the pressed curve would leave the object on its other side. At most `fit.most_depth_m`, and at least a
// twentieth of a voxel, below which nothing of the press would be left. Thick is what all but a tenth of the points
// are: noise turns the normal of some along the surface.
[[nodiscard]] double depthFor(const SurfaceField& field, const SurfaceCurve& curve, const PathFit& fit);

}  // namespace palpate
