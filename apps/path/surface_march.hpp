// SPDX-License-Identifier: Apache-2.0
// apps/path/surface_march.hpp: walks along the isosurface in a cutting plane.
//
// World frame [m]. Set-up code, any thread. Cost: about 40 samples a step, a step being a quarter of a voxel.
#pragma once

#include <vector>

#include "apps/path/surface_search.hpp"

namespace palpate {

// What the walk does where the surface falls away.
enum class OverEdges {
  kFollow,    // goes around every edge, down into holes and along undersides
  kStraight,  // where the surface falls more than 40 degrees below the tangent plane of the start, goes straight on
              // until it meets the object again
};

struct SurfaceCurve {
  std::vector<SurfaceHit> points;  // the first is the start; neighbours are step_m apart
  double step_m = 0;               // [m]
  double free_m = 0;               // part of the length off the surface, beyond edges [m]
  [[nodiscard]] double length() const { return step_m * static_cast<double>(points.size() - 1); }
};

// Walks from `start` for `length_m`, or less where the volume ends. The cutting plane goes through `start` and is
// spanned by its normal and `direction_W` (any vector not along the normal). The walk follows the curve in which this
// plane cuts the isosurface. For each step, the next point is searched for on a circle around the last one: from the
// direction back, the search turns through the outside until it meets the object. It needs no gradient, so unlike a
// step along the tangent it cannot lose a sharp edge.
[[nodiscard]] SurfaceCurve marchSurface(const SurfaceField& field, const SurfaceHit& start, const Vec3& direction_W,
                                        double length_m, OverEdges over_edges = OverEdges::kFollow);

}  // namespace palpate
