// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/hri.hpp: HRI with the paper's gaps mended; the default algorithm.
//
// As in the paper, a virtual plane stands for the surface, F = K d - B v_d, and the plane is renewed every n ticks. The
// mends:
// - n = 1 means every tick. A plane is also renewed in three other cases: an edit has changed the window, the HIP comes
//   in front of the plane, or the HIP has moved so far along the plane that it may be wrong by more than kMostTurned or
//   kMostOff (below).
// - The plane is at the surface point nearest to the HIP (surface_tracker.hpp), not on the line from VHIP to HIP. For n
//   > 1 it is nearest to where the HIP will be a third of the way through the plane's life.
// - Contact ends when the HIP is in front of the sheet that it touched, not when the density at the HIP says so. So a
//   press through a thin wall does not lose the wall. Free motion is searched along its whole path, so no stroke jumps
//   a wall.
// - If the surface cannot be found again with the HIP in the object, the nearest way out that does not lead back
//   through the object is taken. If the window does not show the HIP, the way out is sought from the VHIP, or a VHIP in
//   the air goes on as a free tool. Without a way out kSurfaceLost fades the force until the HIP has been outside. If
//   the surface could not be followed as far as the HIP went, kPlaneBehind fades the force until it has been, with one
//   search a tick.
// - If VHIP and HIP are both inside (the surface moved), the search goes outward along N, then follows the surface as
//   always.
// - A tool that starts inside feels no force until the HIP has been outside once (kInsideObject).
// - A tool that an edit buried is pushed towards the nearest way out (IsoField::nearestExit). The push comes in gently,
//   like everything that an edit adds (vhip_algorithm.hpp). Without a way out in reach there is no force until the HIP
//   has been outside (kInsideObject).
// - If an edit leaves the HIP in the air, with nothing between plane and HIP, the contact ends (IsoField::inAirBehind).
// - There is no force (kBeyondWindow) if the window does not hold the surface point under the HIP, or in free motion
//   the HIP. The contact is remembered. Short gaps in free motion are searched along the straight line once the window
//   has caught up.
// - If the field at the surface is flat (kZeroGradient), the plane keeps its normal. A new plane faces the direction
//   that the HIP came from.
// - Where the volume ends in the object, its face is the surface. The force never pulls: K d - B v_d is clamped at 0.
// Frame W: world. Thread: the servo's. Cost: in contact without renewal no transform and no fetch. A renewal mostly
// takes one to three fetches, deeper than 1.5 voxels seven more, at most what two SurfaceTracker::follow() take. Free
// motion takes one fetch and the cost of IsoField::firstEntry. Searches have stated maxima. Errors: faults.
#pragma once

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/plane_age.hpp"
#include "servo/algorithms/surface_tracker.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class HriSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr double kLongestGap = 16;  // longest gap of free motion beyond the window that is searched [voxel]
  static constexpr double kOutwardSearch = IsoField::kLongestWayOut;  // from a buried HIP along N [voxel]
  static constexpr double kMostBackward = -0.25;  // of a way out, along the normal of a sheet that is lost [-]
  static constexpr double kAim = 1.0 / 3;         // how far ahead a plane is found, as a share of its life [-]
  static constexpr double kLongestAim = 1;        // longest lead; a jump of the tool predicts nothing [voxel]
  static constexpr double kAimInReach = 0.5;     // longest lead, as a share of the distance for which a plane holds [-]
  static constexpr double kAimTolerance = 0.05;  // SurfaceTracker::Limits::line_tolerance for a predicted HIP [voxel]
  // How wrong a plane may be before its n ticks are over. On a surface of radius R, at depth D, a lateral motion w
  // turns the normal at the HIP by w / (R - D), and puts the depth off by half of that angle times w. The rate of
  // turning is measured from one renewal to the next, within the bounds below.
  static constexpr double kMostTurned = 0.105;    // [rad]: 6 degrees
  static constexpr double kMostOff = 0.05;        // of the depth [-]
  static constexpr double kLeastOff = 0.02;       // always allowed: sampling alone puts depths off by as much [voxel]
  static constexpr double kFirstTurn = 1.0 / 8;   // assumed rate before one is measured [rad/voxel]
  static constexpr double kLeastTurn = 1.0 / 64;  // a flat face may end anywhere [rad/voxel]
  static constexpr double kMostTurn = 1.0 / 3;    // noise turns normals faster [rad/voxel]
  // How far the surface point may slide in a renewal: kSlide plus kSlideByWay times the HIP's own motion. A convex
  // surface needs four times that motion if the press is three quarters of its radius deep.
  static constexpr double kSlide = 0.1;     // [voxel]
  static constexpr double kSlideByWay = 4;  // [-]

  // The lesser of the sag over n ticks and of that over the longest way for which a plane is kept. The rate of turning
  // that is assumed is the surface's, or for a contact's first plane kFirstTurn.
  [[nodiscard]] static double planeAgeError(const PlaneAge& age) noexcept;

  explicit HriSurface(const AlgorithmParameters& parameters) noexcept
      : renewal_ticks_(parameters.plane_renewal_ticks), cache_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  void resume(const Vec3& free_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // The surface point that the window must hold for the contact to go on.
  [[nodiscard]] std::optional<Vec3> remembered(const Vec3& hip_W) const noexcept {
    return inContact() ? std::optional<Vec3>(plane().nearest(hip_W)) : std::nullopt;
  }
  [[nodiscard]] ContactPlane plane() const noexcept { return {surface_.p_W, surface_.normal_W, age_ticks_}; }

 private:
  // Where the tool is. The changes:
  // - kInside and kLost to kFree: the tool is seen outside. To kTouching: an edit buried it, and there is a way out.
  // - kFree to kTouching: the tool's path enters the object. To kInside: an edit put material over the tool.
  // - kTouching to kFree: contact ends with the HIP outside. To kLost: the HIP is in the object, and no surface is
  //   found. Else to kInside.
  enum class Tool : std::uint8_t {
    kInside,    // started in the object, or is not known to be outside: no force
    kFree,      // free_ was outside, so the line from it to the HIP can be searched for an entry
    kTouching,  // there is a plane; the HIP was behind it when it was found
    kLost,      // in the object after its contact was lost: no force, and a fault
  };

  [[nodiscard]] bool inContact() const noexcept { return tool_ == Tool::kTouching; }
  void refreshField(const SampleWindow& window) noexcept;
  [[nodiscard]] Vec3 aim(const Vec3& hip_W) const noexcept;
  [[nodiscard]] Track follow(const Vec3& hip_W, bool ahead) noexcept;
  void takeNearestExit(const Probe& hip, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool leftReach(const Vec3& hip_W) const noexcept;
  void renew(const Vec3& hip_W, bool ahead, std::uint32_t& faults) noexcept;
  void renewed(const Vec3& hip_W, const Vec3& last_normal_W) noexcept;
  void relocate(const Probe& hip, bool gone, std::uint32_t& faults) noexcept;
  void moveFreely(const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool touch(const Entry& entry, const Probe& hip, bool inside, std::uint32_t& faults) noexcept;
  void begin(const SurfacePoint& surface, const Vec3& hip_W) noexcept;
  [[nodiscard]] static double reachSquared(double per_turn_squared, double depth_m, double voxel_m) noexcept;
  void settle(const Vec3& hip_W) noexcept;
  void release(const Probe& hip) noexcept;

  std::int32_t renewal_ticks_;
  SurfacePoint surface_;  // the plane: its point and normal
  std::int32_t age_ticks_ = 0;
  Vec3 renewed_at_W_ = Vec3::Zero();  // the HIP when the plane was found
  Vec3 found_for_W_ = Vec3::Zero();   // the place that the plane was found for: renewed_at_W_ or ahead of it
  double per_turn_squared_ = 0;       // lateral motion over which the normal turns by 1 rad, squared [voxel^2]
  double reach_squared_m2_ = 0;       // lateral distance from found_for_W_ within which the plane holds, squared
  TrackMemory memory_;                // what searches have learnt about this contact's surface
  Vec3 vhip_W_ = Vec3::Zero();
  Tool tool_ = Tool::kInside;
  bool behind_ = false;   // the HIP went farther than the surface could be followed
  bool held_ = false;     // the last tick could not see the HIP; no force until one can
  bool buried_ = false;   // an edit covered free_ while the HIP could not be seen
  bool resumed_ = false;  // free_ came from another algorithm, so it counts however far away it is
  std::uint64_t edit_version_ = 0;

  Probe free_;  // last place of the HIP that is known to be outside
  FieldCache cache_;
  const IsoField* field_ = nullptr;  // the cache's field of the present window
};

using Hri = VhipAlgorithm<HriSurface>;

}  // namespace palpate
