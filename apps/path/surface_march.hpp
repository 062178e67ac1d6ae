// SPDX-License-Identifier: Apache-2.0
// apps/path/surface_march.hpp: follows the isosurface in a cutting plane, as a finger follows an edge.
//
// World frame [m]. Set-up code, any thread. Cost: about 40 samples a step, a step being a quarter of a voxel.
#pragma once

#include <vector>

#include "apps/path/surface_search.hpp"

namespace palpate {

struct SurfaceCurve {
  std::vector<SurfacePoint> points;  // the first is the start; neighbours are step_m apart
  double step_m = 0;                 // [m]
  [[nodiscard]] double length() const { return step_m * static_cast<double>(points.size() - 1); }
};

// Walks from `start` along the curve in which the plane through it, spanned by its normal and `direction` (any vector
// not along the normal), cuts the isosurface; over edges and into holes; until `length_m`, or shorter at the volume's
// border. Each step goes to the place on a circle around the last point where, turning from the way it came through the
// outside, the object is met first. Unlike a step along the tangent this cannot lose a sharp edge: it needs no
// gradient.
[[nodiscard]] SurfaceCurve marchSurface(const SurfaceField& field, const SurfacePoint& start, const Vec3& direction_W,
                                        double length_m);

}  // namespace palpate
