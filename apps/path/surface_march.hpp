// SPDX-License-Identifier: Apache-2.0
// apps/path/surface_march.hpp: follows the isosurface in a cutting plane, as a finger follows an edge.
//
// World frame [m]. Set-up code, any thread. Cost: about 40 samples a step, a step being a quarter of a voxel.
#pragma once

#include <vector>

#include "apps/path/surface_search.hpp"

namespace palpate {

// What the walk does where the surface falls away.
enum class OverEdges {
  kFollow,    // it goes around every edge, down into holes and along undersides
  kStraight,  // where the surface falls more than 40 degrees below the start's plane it goes straight on, as a finger
              // that an arm guides, until it meets the object again
};

struct SurfaceCurve {
  std::vector<SurfaceHit> points;  // the first is the start; neighbours are step_m apart
  double step_m = 0;               // [m]
  double free_m = 0;               // of its length, not on the surface: straight on beyond an edge [m]
  [[nodiscard]] double length() const { return step_m * static_cast<double>(points.size() - 1); }
};

// Walks from `start` along the curve in which the plane through it, spanned by its normal and `direction` (any vector
// not along the normal), cuts the isosurface; over edges and into holes; until `length_m`, or shorter at the volume's
// border. Each step goes to the place on a circle around the last point where, turning from the way it came through the
// outside, the object is met first. Unlike a step along the tangent this cannot lose a sharp edge: it needs no
// gradient.
[[nodiscard]] SurfaceCurve marchSurface(const SurfaceField& field, const SurfaceHit& start, const Vec3& direction_W,
                                        double length_m, OverEdges over_edges = OverEdges::kFollow);

}  // namespace palpate
