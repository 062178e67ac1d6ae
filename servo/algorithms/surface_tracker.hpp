// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/surface_tracker.hpp: from a surface point found before to the surface point nearest to the HIP.
//
// A step goes along the sampled gradient to the isovalue (Newton) and along the tangent plane towards the HIP, both at
// most a voxel long, until the HIP lies on the normal line. It follows the sheet on which it began, so a HIP that has
// gone through a thin wall is still held by the side where it came in (as the god-object of Zilles and Salisbury, 1995;
// the point is that of Salisbury and Tarr's implicit-surface proxy, 1997). Where the sheet is the front of a wall so
// thin that Newton's steps cross it, its normal turns over; then the sheet is found again by a line cast from in front
// of the old plane straight in, which meets the front first. A cut face of the volume is a sheet too. Frame W: world
// [m]. Thread: the servo's. Cost: one fetch when the surface turned little since, at most kMaxSteps + 1 on the
// isosurface and some 40 more for a line cast, and kMaxEdgeSteps more when a cut face ends. Errors: the result says.
#pragma once

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

struct SurfacePoint {
  Vec3 p_W = Vec3::Zero();       // [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
  CutFace face;                  // the cut face that it lies on, if any
};

enum class Track : std::uint8_t {
  kFound,         // the point and its normal are new
  kFoundFlat,     // the point is new; the field gives no normal there, or one that faces inward: it is the old one
  kLost,          // the isosurface is not near any more
  kFlat,          // zero or non-finite gradient: no normal
  kBeyondWindow,  // the way leads to where the window holds nothing
  kLeftVolume,    // the sheet ends at a face of the volume, and the HIP is beyond it
};

class SurfaceTracker {
 public:
  static constexpr int kMaxSteps = 8;
  static constexpr int kMaxEdgeSteps = 12;
  // A point counts as found when the HIP is this near to its normal line and the last Newton step, which is still
  // taken, was this short [voxel]. At 20 voxels of radius the first is 0.06 degrees.
  static constexpr double kLineTolerance = 0.02;
  static constexpr double kDensityTolerance = 0.02;
  // Out of steps, a point this near to the surface is still used [voxel].
  static constexpr double kUsable = 0.25;
  // How far in front of and behind the old plane the sheet is looked for where Newton has lost it [voxel].
  static constexpr double kCastReach = 1.5;

  // Moves `surface` only when it is found.
  // `line_tolerance` [voxel]: how near the HIP has to come to the normal line.
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    double line_tolerance = kLineTolerance) noexcept;

 private:
  [[nodiscard]] static Track followIsosurface(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                              double line_tolerance) noexcept;
  [[nodiscard]] static Track newton(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    double line_tolerance) noexcept;
  [[nodiscard]] static Track cast(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept;
  [[nodiscard]] static Track followFace(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                        double line_tolerance) noexcept;
};

}  // namespace palpate
