// SPDX-License-Identifier: Apache-2.0
// apps/path/pressed_curve.hpp: the tool's path during the slide: the surface curve, moved into the object by the depth
// of the press.
//
// World frame [m]. Set-up code. at() costs a few multiply-adds and may be called from any thread.
#pragma once

#include <vector>

#include "apps/path/surface_march.hpp"

namespace palpate {

// The points c and the normals n of the surface curve are smoothed along the arc by Gaussians. A cubic (Catmull-Rom)
// spline then joins the points h = c - depth * n, so the path is C1 even over a sharp edge.
//  - c is smoothed with sigma 0.75 voxel: on a curve of radius R this moves it inward by about (0.75 voxel)^2 / (2 R).
//  - n is smoothed with sigma s = max(1.5 voxel, depth) and not normalised again. With unsmoothed n, h would go back
//    around a convex edge. Where the surface turns fast, the depth lessens smoothly, by exp(-s^2 / (2 R^2)).
// Both ends are kept exactly (odd continuation) where the curve is longer than a kernel reaches, four standard
// deviations, so that the press meets the surface where it was meant to.
class PressedCurve {
 public:
  // `voxel_m`: the volume's smallest spacing [m].
  PressedCurve(const SurfaceCurve& surface, double depth_m, double voxel_m);
  // Tool position at a fraction 0..1 of the slide [m].
  [[nodiscard]] Vec3 at(double share) const;
  // The fraction of its points that are outside the object. Beyond the volume counts as inside.
  [[nodiscard]] double shareOutside(const SurfaceField& field) const;

 private:
  std::vector<Vec3> points_W_;
};

}  // namespace palpate
