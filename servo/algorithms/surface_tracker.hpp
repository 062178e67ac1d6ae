// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/surface_tracker.hpp: from a surface point found before to the surface point nearest to the HIP.
//
// A step goes along the sampled gradient to the isovalue (Newton) and along the tangent plane towards the HIP, both at
// most a voxel long, until the HIP lies on the normal line. It follows the sheet on which it began, so a HIP that has
// gone through a thin wall is still held by the side where it came in (as the god-object of Zilles and Salisbury, 1995;
// the point is that of Salisbury and Tarr's implicit-surface proxy, 1997). Where the sheet is the front of a wall so
// thin that Newton's steps cross it, its normal turns over; then the sheet is found again by a line cast from in front
// of the old plane straight in, which meets the front first. A cut face of the volume is a sheet too.
//
// Deep presses. A tangential step of the whole way aside gains the share 1 - D / R of it where the surface is convex
// (depth D, radius R), and overshoots by D / R where it is hollow. On a noisy surface no two normals agree, and at D
// voxels every degree of a normal is D / 57 voxels aside: there is no point whose normal line meets the HIP, and the
// steps wander. So a step takes a share of the way, `pace`, that falls where steps do not gain and grows where they
// gain slowly; it stays with the surface point from search to search. Where the search ends without agreement, the
// plane's normal is turned from the sampled one towards the line from the HIP to the surface point, the more the deeper
// the press: of the two the line is the better known, by noise / D. Without noise both are the same.
//
// Frame W: world [m]. Thread: the servo's. Cost: one fetch when the surface turned little since; at most kMaxSteps + 1
// and one for each voxel of way, up to kMaxWay, on the isosurface, each with seven more where it is rough; seven where
// it is asked whether it is (kDeep, kJudgedFor); some 40 more for each of up to kMaxCasts line casts,
// and kMaxEdgeSteps more when a cut face ends. Errors: the result says.
#pragma once

#include <limits>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

struct SurfacePoint {
  Vec3 p_W = Vec3::Zero();       // [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
  CutFace face;                  // the cut face that it lies on, if any
};

// What searches of one contact learn of its surface. A new contact begins with a new one.
struct TrackMemory {
  double pace = 1;            // share of the way aside that a step takes [-]
  bool rough = false;         // normals near each other disagree, so means are taken
  double slide = 1;           // on a rough surface: how many times the HIP's way the point may slide [-]
  bool short_of_way = false;  // the last search ended for want of that
  Vec3 judged_W = Vec3::Constant(std::numeric_limits<double>::infinity());  // where they were last compared [m]
};

enum class Track : std::uint8_t {
  kFound,         // the point and its normal are new
  kFoundFlat,     // the point is new; the field gives no normal there, or one that faces inward: it is the old one
  kBehind,        // as far as it could go; the HIP has gone farther
  kLost,          // the isosurface is not near any more
  kFlat,          // zero or non-finite gradient: no normal
  kBeyondWindow,  // the way leads to where the window holds nothing
  kLeftVolume,    // the sheet ends at a face of the volume, and the HIP is beyond it
};

class SurfaceTracker {
 public:
  static constexpr int kMaxSteps = 8;  // and one for each voxel of way
  static constexpr int kMaxWay = 64;   // of the HIP along the surface, that one search follows [voxel]
  static constexpr int kMaxEdgeSteps = 12;
  // A point counts as found when the HIP is this near to its normal line and the last Newton step, which is still
  // taken, was this short [voxel]. At 20 voxels of radius the first is 0.06 degrees.
  static constexpr double kLineTolerance = 0.02;
  static constexpr double kDensityTolerance = 0.02;
  // Out of steps, a point this near to the surface is still used [voxel].
  static constexpr double kUsable = 0.25;
  // The normal turns by half towards the line from the HIP at this depth [voxel].
  static constexpr double kHalfTurned = 1;
  // A surface is rough where the normal line of one point and that of the mean of seven are so far apart at the HIP, or
  // farther [voxel]. From this depth on it is looked for, each time that the point has gone so far [voxel].
  static constexpr double kRough = 0.25;
  static constexpr double kDeep = 1.5;
  static constexpr double kJudgedFor = 0.5;
  // On a rough surface: steps of a search, and how far apart the normals of the mean are taken, as a share of the depth
  // and within bounds [voxel].
  static constexpr int kRoughSteps = 4;
  static constexpr double kSpread = 1.0 / 6, kLeastSpread = 1.5, kMostSpread = 4;
  static constexpr double kLowestPace = 1.0 / 32, kHighestPace = 4;
  // Of TrackMemory::slide: in a search that ended for want of way, in another, and where it begins and falls back to.
  static constexpr double kSlideGrowth = 1.5, kSlideDecay = 0.67, kLeastSlide = 1;
  // How far in front of and behind the old plane the sheet is looked for where Newton has lost it [voxel].
  static constexpr double kCastReach = 1.5;
  static constexpr int kMaxCasts = 8;

  struct Limits {
    double line_tolerance = kLineTolerance;  // from the HIP to the normal line [voxel]
    // How far the point may slide beyond the HIP's own way: so far, and TrackMemory::slide times that way, which grows
    // up to this while searches end for want of way, and falls back.
    double slide_m = std::numeric_limits<double>::infinity();
    double slide_by_way = 4;
    double way_squared_m2 = 0;  // of the HIP, since the last search
  };

  // Moves `surface` only when the result is kFound, kFoundFlat or kBehind.
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory, const Limits& limits) noexcept;
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory) noexcept {
    return follow(field, hip_W, surface, memory, Limits{});
  }

  // How far apart two normal lines of one point are at a depth [m].
  [[nodiscard]] static double apart(const Vec3& a_W, const Vec3& b_W, double depth_m) noexcept {
    return (a_W - b_W).norm() * depth_m;
  }

 private:
  [[nodiscard]] static Track followIsosurface(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                              TrackMemory& memory, const Limits& limits) noexcept;
  [[nodiscard]] static Track cast(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, bool rough) noexcept;
  [[nodiscard]] static Track followFace(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                        TrackMemory& memory, const Limits& limits) noexcept;
};

}  // namespace palpate
