// SPDX-License-Identifier: Apache-2.0
// apps/path/pressed_curve.hpp: the tool's way while it slides: the surface curve, moved into the object by the press
// depth.
//
// World frame [m]. Set-up code. Built once; at() costs a few multiply-adds and may be called from any thread.
#pragma once

#include <vector>

#include "apps/path/surface_march.hpp"

namespace palpate {

// Points c and normals n of the surface curve are each smoothed along the arc by a Gaussian, then h = c - depth * n is
// joined by a cubic (Catmull-Rom) spline, so the way is C1 even over a sharp edge.
//  - c is smoothed over 0.75 voxel: on a curve of radius R this moves it inward by about (0.75 voxel)^2 / (2 R).
//  - n is smoothed over max(1.5 voxel, depth) and not normalised again: around a convex edge the offset of an
//  unsmoothed
//    normal would run backwards, and depth lessens smoothly where the surface turns fast, by exp(-s^2 / (2 R^2)).
// Both ends are kept exactly (odd continuation), so that the press meets the slide.
class PressedCurve {
 public:
  // `voxel_m`: the volume's smallest spacing [m].
  PressedCurve(const SurfaceCurve& surface, double depth_m, double voxel_m);
  // Tool position at a share 0..1 of the slide [m].
  [[nodiscard]] Vec3 at(double share) const;
  // Of its points: those that are not in the object. Beyond the volume counts as inside.
  [[nodiscard]] double shareOutside(const SurfaceField& field) const;

 private:
  std::vector<Vec3> points_W_;
};

}  // namespace palpate
