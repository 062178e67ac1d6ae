// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/surface_tracker.hpp: from a surface point found before to the surface point nearest to the HIP.
//
// A step goes along the sampled gradient to the isovalue (Newton) and along the tangent plane towards the HIP, both at
// most a voxel long, until the HIP lies on the normal line. The search follows the sheet on which it began. So a HIP
// that has gone through a thin wall is still held by the side where it came in, as with the god-object of Zilles and
// Salisbury (1995); the point is that of the implicit-surface proxy of Salisbury and Tarr (1997). If the sheet is the
// front of a wall so thin that Newton's steps cross it, the normal turns over. Then a line is cast from in front of the
// old plane straight in, which meets the front of the wall first. A cut face of the volume is a sheet too.
//
// Deep presses. The way aside is the part of the line to the HIP along the surface (depth D, radius R). A tangential
// step of all of it gains only the share 1 - D / R where the surface is convex, and overshoots by D / R where it is
// hollow. On a noisy surface no two normals agree, and at a depth of D voxels every degree of a normal is D / 57 voxels
// aside. Then there may be no point whose normal line meets the HIP, and the steps wander. So a step takes a share of
// the way aside, `pace`. It falls where steps do not gain and grows where they gain slowly, and is kept from search to
// search. If a search ends without agreement, the plane's normal is turned from the sampled one towards the line from
// the HIP to the surface point, the more the deeper the press. That line is the better known of the two, by noise / D.
// Without noise both are the same.
//
// Frame W: world [m]. Thread: the servo's. Cost in fetches: one if the surface turned little since. At most kMaxSteps +
// 1 on the isosurface, and one for each voxel of way up to kMaxWay; each with seven more where the surface is rough.
// Seven to judge whether it is rough (kDeep, kJudgedFor). Some 40 for each of up to kMaxCasts line casts, and
// kMaxEdgeSteps where a cut face ends. Errors: the result says.
#pragma once

#include <limits>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

struct SurfacePoint {
  Vec3 p_W = Vec3::Zero();       // [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
  CutFace face;                  // the cut face that it lies on, if any
};

// What the searches of one contact have learnt of its surface. A new contact starts with a new TrackMemory.
struct TrackMemory {
  double pace = 1;            // share of the way aside that a step takes [-]
  bool rough = false;         // neighbouring normals disagree, so their means are taken
  double slide = 1;           // on a rough surface the point may slide this many times the HIP's way [-]
  bool short_of_way = false;  // the last search ended before the point had slid far enough
  Vec3 judged_W = Vec3::Constant(std::numeric_limits<double>::infinity());  // where normals were last compared [m]
};

enum class Track : std::uint8_t {
  kFound,         // the point and its normal are new
  kFoundFlat,     // the point is new, the normal the old one: the field gives none there, or one that faces inward
  kBehind,        // the point is new, but the HIP has gone farther than the search
  kLost,          // the isosurface is no longer near
  kFlat,          // zero or non-finite gradient: no normal
  kBeyondWindow,  // the way leads out of the window
  kLeftVolume,    // the sheet ends at a face of the volume, and the HIP is beyond it
};

class SurfaceTracker {
 public:
  static constexpr int kMaxSteps = 8;  // and one more for each voxel of way
  static constexpr int kMaxWay = 64;   // longest way of the HIP along the surface that one search follows [voxel]
  static constexpr int kMaxEdgeSteps = 12;
  // A point counts as found when the HIP is this near to its normal line and the last Newton step, which is still
  // taken, was this short [voxel]. At a radius of 20 voxels the first is 0.06 degrees.
  static constexpr double kLineTolerance = 0.02;
  static constexpr double kDensityTolerance = 0.02;
  // When the steps run out, a point this near to the surface is still used [voxel].
  static constexpr double kUsable = 0.25;
  // At this depth the normal is turned half way towards the line from the HIP [voxel].
  static constexpr double kHalfTurned = 1;
  // A surface is rough where the normal line of one point and that of the mean of seven are kRough or more apart at the
  // HIP [voxel]. That is judged from the depth kDeep on, each time the point has moved by kJudgedFor [voxel].
  static constexpr double kRough = 0.25;
  static constexpr double kDeep = 1.5;
  static constexpr double kJudgedFor = 0.5;
  // On a rough surface: steps of a search, and how far from the point the other normals of the mean are taken. kSpread
  // is a share of the depth; the bounds are in voxels.
  static constexpr int kRoughSteps = 4;
  static constexpr double kSpread = 1.0 / 6, kLeastSpread = 1.5, kMostSpread = 4;
  static constexpr double kLowestPace = 1.0 / 32, kHighestPace = 4;
  // TrackMemory::slide is multiplied by kSlideGrowth after a search that was short_of_way, else by kSlideDecay. It
  // begins at kLeastSlide and never falls below it.
  static constexpr double kSlideGrowth = 1.5, kSlideDecay = 0.67, kLeastSlide = 1;
  // How far in front of and behind the old plane a cast looks for a sheet that Newton has lost [voxel].
  static constexpr double kCastReach = 1.5;
  static constexpr int kMaxCasts = 8;

  struct Limits {
    double line_tolerance = kLineTolerance;  // from the HIP to the normal line [voxel]
    // How far the point may slide: slide_m, and the HIP's own way times slide_by_way. On a rough surface
    // TrackMemory::slide stands in place of slide_by_way, which is its upper bound.
    double slide_m = std::numeric_limits<double>::infinity();
    double slide_by_way = 4;
    double way_squared_m2 = 0;  // way of the HIP since the last search, squared
  };

  // Moves `surface` only when the result is kFound, kFoundFlat or kBehind.
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory, const Limits& limits) noexcept;
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory) noexcept {
    return follow(field, hip_W, surface, memory, Limits{});
  }

  // How far apart two normal lines through one point are at a depth [m].
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
