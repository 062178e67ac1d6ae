// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/surface_tracker.hpp: from a surface point that was found before to the surface point nearest to the
// HIP.
//
// A step goes along the sampled gradient to the isovalue (Newton), and along the tangent plane towards the HIP. Both
// parts are at most a voxel long. Steps go on until the HIP lies on the normal line. The search follows the sheet on
// which it began. So a HIP that has gone through a thin wall is still held by the side where it came in, as with the
// god-object of Zilles and Salisbury (1995). The point is that of the implicit-surface proxy of Salisbury and Tarr
// (1997).
// If the sheet is the front of a wall so thin that Newton's steps cross it, the normal turns over. Then a line is cast
// from in front of the old plane straight in. It meets the front of the wall first. A cut face of the volume is a sheet
// too.
//
// Deep presses. The lateral offset is the part of the line from surface point to HIP along the surface (depth D, radius
// R). A tangential step of the whole offset gains only the share 1 - D / R where the surface is convex, and overshoots
// by D / R where it is hollow. On a noisy surface no two normals agree. At a depth of D voxels every degree of a normal
// is a lateral offset of D / 57 voxels. Then there may be no point whose normal line meets the HIP, and the steps
// wander. So a step takes a share of the offset, the `pace`. It falls where steps do not gain and grows where they gain
// slowly. It is kept from search to search.
// If a search ends without agreement, the plane's normal is turned from the sampled one towards the line from the HIP
// to the surface point, the more the deeper the press. The direction of that line is better known than the normal: it
// errs by noise / D. Without noise both are the same.
//
// Frame W: world [m]. Thread: the servo's. Cost in fetches:
// - one if the surface has turned little since the last search;
// - at most kMaxSteps + 1 on the isosurface, and one for each voxel of lateral motion up to kMaxWay; each with seven
//   more where the surface is rough;
// - seven to judge whether it is rough (kDeep, kJudgedFor);
// - some 40 for each of up to kMaxCasts line casts, and kMaxEdgeSteps where a cut face ends.
// Errors: the result says.
#pragma once

#include <limits>

#include "servo/algorithms/iso_field.hpp"

namespace palpate {

struct SurfacePoint {
  Vec3 p_W = Vec3::Zero();       // [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
  CutFace face;                  // the cut face that it lies on, if any
};

// What the searches of one contact have learnt about its surface. A new contact starts with a new TrackMemory.
struct TrackMemory {
  double pace = 1;            // share of the lateral offset that a step takes [-]
  bool rough = false;         // neighbouring normals disagree, so their mean is used
  double slide = 1;           // on a rough surface the point may slide this many times the HIP's motion [-]
  bool short_of_way = false;  // the last search ended before the point had slid far enough
  Vec3 judged_W = Vec3::Constant(std::numeric_limits<double>::infinity());  // where normals were last compared [m]
};

enum class Track : std::uint8_t {
  kFound,         // the point and its normal are new
  kFoundFlat,     // the point is new, the normal old: the field gives none there, or one that faces inward
  kBehind,        // the point is new, but the HIP has moved farther than the search could follow
  kLost,          // the isosurface is no longer near, or the field gives no normal on the way to it
  kBeyondWindow,  // the search leads out of the window
  kLeftVolume,    // the sheet ends at a face of the volume, and the HIP is beyond it
};

class SurfaceTracker {
 public:
  static constexpr int kMaxSteps = 8;  // and one more for each voxel of lateral motion
  static constexpr int kMaxWay = 64;   // longest lateral motion of the HIP that one search follows [voxel]
  static constexpr int kMaxEdgeSteps = 12;
  // A point counts as found when the HIP is within kLineTolerance of its normal line, and the last Newton step is
  // within kDensityTolerance [voxel]. That step is still taken. At a radius of 20 voxels the first is 0.06 degrees.
  static constexpr double kLineTolerance = 0.02;
  static constexpr double kDensityTolerance = 0.02;
  // When the steps run out, a point this near to the isosurface is still used [voxel].
  static constexpr double kUsable = 0.25;
  // At this depth the normal is turned half way towards the line from the HIP [voxel].
  static constexpr double kHalfTurned = 1;
  // A surface is rough where the normal line of one point and that of the mean of seven normals are kRough or more
  // apart at the HIP [voxel]. This is judged at depths beyond kDeep, each time the point has moved by kJudgedFor
  // [voxel].
  static constexpr double kRough = 0.25;
  static constexpr double kDeep = 1.5;
  static constexpr double kJudgedFor = 0.5;
  static constexpr int kRoughSteps = 4;  // of a search on a rough surface
  static constexpr double kLowestPace = 1.0 / 32, kHighestPace = 4;
  // TrackMemory::slide is multiplied by kSlideGrowth after a search that was short_of_way, else by kSlideDecay. It
  // begins at kLeastSlide and never falls below it.
  static constexpr double kSlideGrowth = 1.5, kSlideDecay = 0.67, kLeastSlide = 1;
  // How far in front of and behind the old plane a cast looks for a sheet that Newton's steps have lost [voxel].
  static constexpr double kCastReach = 1.5;
  static constexpr int kMaxCasts = 8;

  struct Limits {
    double line_tolerance = kLineTolerance;  // from the HIP to the normal line [voxel]
    // How far the point may slide: slide_m plus slide_by_way times the HIP's own motion. On a rough surface
    // TrackMemory::slide takes the place of slide_by_way, which is then its upper bound.
    double slide_m = std::numeric_limits<double>::infinity();
    double slide_by_way = 4;
    double way_squared_m2 = 0;  // motion of the HIP since the last search, squared
  };

  // Moves `surface` only when the result is kFound, kFoundFlat or kBehind.
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory, const Limits& limits) noexcept;
  [[nodiscard]] static Track follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                    TrackMemory& memory) noexcept {
    return follow(field, hip_W, surface, memory, Limits{});
  }

  // How far apart two normal lines through one point are at a depth: the distance of their points there [m].
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
