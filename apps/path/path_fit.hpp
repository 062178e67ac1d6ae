// SPDX-License-Identifier: Apache-2.0
// apps/path/path_fit.hpp: default lengths of a path (depth, slide, approach) that fit the object.
//
// World frame [m]. Set-up code, any thread while the field does not change.
#pragma once

#include "apps/path/object_pieces.hpp"
#include "apps/path/surface_march.hpp"

namespace palpate {

// For an object from 3 to 40 cm the lengths are those of a finger: 10 mm of approach, 1 mm of depth, 20 mm of slide. A
// smaller object gets less and a larger one more, in proportion to its size. In a coarse volume the approach is at
// least two voxels and the depth at least a twentieth of a voxel, of the smallest spacing. The depth is never above 4
// mm, which a surface of the default stiffness answers with 2 N.
struct PathFit {
  double approach_m = 0;
  double slide_m = 0;
  double most_depth_m = 0;  // on a thick object; depthFor() lessens it on a thin one
};

// `size_m`: the longest edge of the box around the piece that is touched; `voxel_m`: the smallest spacing.
[[nodiscard]] PathFit fitTo(double size_m, double voxel_m);

// The longest edge of the box around a piece, with half a sample more on each side [m].
[[nodiscard]] double sizeOf(const ObjectPiece& piece, const Lattice& lattice);

// Thickness of the object under a surface point, against its normal, up to `reach_m` [m]. Beyond the volume counts as
// object. Steps of an eighth of a voxel or a sixteenth of the reach, whichever is less.
[[nodiscard]] double thicknessAt(const SurfaceField& field, const SurfaceHit& at, double reach_m);

// Depth of the press along a curve [m]: a quarter of the object's thickness, so that the surface nearest to the tool is
// the one that it pressed. Halved until the pressed curve no longer leaves the object on its other side. At most
// `fit.most_depth_m` and at least a twentieth of a voxel. The thickness is the tenth percentile over the curve's
// points: a tenth may be thinner, since noise can turn their normals along the surface.
[[nodiscard]] double depthFor(const SurfaceField& field, const SurfaceCurve& curve, const PathFit& fit);

}  // namespace palpate
