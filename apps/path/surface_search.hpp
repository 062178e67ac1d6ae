// SPDX-License-Identifier: Apache-2.0
// apps/path/surface_search.hpp: finds points of the isosurface: along a ray, beside a point, nearest to a point.
//
// World frame [m]. Set-up code; any thread while the field does not change. Nothing here throws; a miss is an empty
// optional.
#pragma once

#include <optional>

#include "apps/path/surface_field.hpp"

namespace palpate {

struct SurfaceHit {
  Vec3 p_W = Vec3::Zero();       // on the isosurface [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
};

// Density minus isovalue: above 0 is object. Empty outside the volume.
[[nodiscard]] std::optional<double> heightAt(const SurfaceField& field, const Vec3& p_W);

// -grad/|grad|; empty outside the volume and where the gradient vanishes.
[[nodiscard]] std::optional<Vec3> normalAt(const SurfaceField& field, const Vec3& p_W);

// First point on origin + s * direction (unit), 0 <= s <= reach, where background turns into object. Steps of half a
// voxel, then bisection to 1e-6 voxel. Cost: about 2 * reach / voxel samples.
[[nodiscard]] std::optional<SurfaceHit> firstEntry(const SurfaceField& field, const Vec3& origin_W,
                                                   const Vec3& direction_W, double reach_m);

// Free distance from a surface point along `direction_W` (unit) before the object is entered, at most `reach_m` [m].
[[nodiscard]] double freeDistance(const SurfaceField& field, const SurfaceHit& from, const Vec3& direction_W,
                                  double reach_m);

// Newton steps along the gradient from a point within a few voxels of the surface; at most 60 of half a voxel each.
[[nodiscard]] std::optional<SurfaceHit> snapToSurface(const SurfaceField& field, const Vec3& near_W);

// The surface point nearest to `p_W` within `reach_m`: rays in 600 directions, then sliding towards the foot point.
[[nodiscard]] std::optional<SurfaceHit> nearestSurfacePoint(const SurfaceField& field, const Vec3& p_W, double reach_m);

}  // namespace palpate
