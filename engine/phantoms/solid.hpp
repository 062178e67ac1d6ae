// SPDX-License-Identifier: Apache-2.0
// engine/phantoms/solid.hpp: bodies with exact signed distances, and how they combine. Private to engine/phantoms.
//
// Frame: world [m]. Distances are negative inside. Combining keeps the zero set exact and the distance 1-Lipschitz.
// unite() is exact outside, intersect() inside. Elsewhere the magnitude is at most that of the true distance.
// Source: Hart, "Sphere tracing" (The Visual Computer 12, 1996), section on constructive solid geometry.
#pragma once

#include "engine/phantoms/phantom.hpp"

namespace palpate {

// Densities as in a CT scan [Hounsfield].
inline constexpr double kAir = -1000;
inline constexpr double kSoft = 40;
inline constexpr double kSlopePerVoxel = 150;  // of a ramp between two tissues [density/voxel]

[[nodiscard]] inline SurfaceOffset unite(const SurfaceOffset& a, const SurfaceOffset& b) {
  return a.distance_m < b.distance_m ? a : b;
}
[[nodiscard]] inline SurfaceOffset intersect(const SurfaceOffset& a, const SurfaceOffset& b) {
  return a.distance_m > b.distance_m ? a : b;
}
[[nodiscard]] inline SurfaceOffset complement(const SurfaceOffset& a) {
  return {-a.distance_m, -a.normal};
}
[[nodiscard]] inline SurfaceOffset subtract(const SurfaceOffset& a, const SurfaceOffset& b) {
  return intersect(a, complement(b));
}

// Exact everywhere.
[[nodiscard]] SurfaceOffset sphereOffset(const Vec3& p_W, const Vec3& centre_W, double radius_m);
[[nodiscard]] SurfaceOffset boxOffset(const Vec3& p_W, const Vec3& half_edges_m);  // centred, along the axes
// All points within radius_m of the segment from `from_W` to `to_W`. Exact everywhere.
[[nodiscard]] SurfaceOffset capsuleOffset(const Vec3& p_W, const Vec3& from_W, const Vec3& to_W, double radius_m);
// Centred, semi-axes along the world's. Exact to about 1e-14 of the largest semi-axis.
[[nodiscard]] SurfaceOffset ellipsoidOffset(const Vec3& p_W, const Vec3& centre_W, const Vec3& semi_axes_m);
// Endless along z.
[[nodiscard]] SurfaceOffset ellipticCylinderOffset(const Vec3& p_W, const Vec3& centre_W, double semi_x_m,
                                                   double semi_y_m);

// A ramp of 1000 on either side of 0 over three voxels of the largest spacing.
[[nodiscard]] Phantom::Profile simpleProfile(const PhantomSpec& spec);

// Half the shortest edge of the lattice, between voxel centres [m].
[[nodiscard]] double halfExtent_m(const PhantomSpec& spec);

}  // namespace palpate
