// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/hri.hpp: HRI with the paper's gaps mended; the default algorithm.
//
// As in the paper, a virtual plane stands for the surface, F = K d - B v_d, and the plane is renewed now and then.
// Mended:
// - n = 1 means every tick; a plane is also renewed as soon as an edit changes the window or the HIP comes out of it.
// - The plane is at the surface point nearest to the HIP (surface_tracker.hpp), not on the line from VHIP to HIP, and,
//   for n > 1, nearest to where the HIP will be a third of the way through the plane's life.
// - Contact ends when the HIP is in front of the sheet that it touched, not when the density at the HIP says so; so a
//   press through a thin wall does not lose it. Free motion is searched along its whole way: no stroke jumps a wall.
// - VHIP and HIP both inside (the surface moved): search outward along N, then follow the surface as always.
// - Inside at the start: no force until the HIP has been outside once (kInsideObject).
// - A tool that an edit buried is pushed towards the nearest way out (IsoField::nearestExit), gently, as all that an
//   edit adds (vhip_algorithm.hpp); without a way out in reach there is no force until it has been outside
//   (kInsideObject).
// - Surface under the HIP, or in free motion the HIP, beyond the window: no force (kBeyondWindow). What was touched is
//   remembered; short gaps in free motion are searched along the straight line, once the window has caught up.
// - Flat field at the surface (kZeroGradient): the plane keeps its normal, a new one faces the way the HIP came.
// - Where the volume ends in the object, its face is the surface. The force never pulls: K d - B v_d is clamped at 0.
// Frame W: world. Thread: the servo's. Cost: in contact without renewal no transform and no fetch; with renewal mostly
// one to three fetches, at most what two SurfaceTracker::follow() take; in free motion one fetch, and for ways of more
// than a quarter voxel what IsoField::firstEntry says. Searches have stated maxima. Errors: faults.
#pragma once

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/surface_tracker.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class HriSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr double kLongestGap = 16;  // free motion beyond the window that is searched afterwards [voxel]
  static constexpr double kOutwardSearch = IsoField::kLongestWayOut;  // from a buried HIP along N [voxel]
  static constexpr double kAim = 1.0 / 3;        // of a plane's life, that it is found ahead of the HIP [-]
  static constexpr double kLongestAim = 1;       // ahead of the HIP: jumps of the tool are no motion to go by [voxel]
  static constexpr double kAimTolerance = 0.05;  // the nearest point to where the HIP may be: as surface_tracker.hpp's
  static constexpr double kStandOff = 0.25;      // in front of the VHIP, where a search from it begins [voxel]

  explicit HriSurface(const AlgorithmParameters& parameters) noexcept
      : renewal_ticks_(parameters.plane_renewal_ticks), cache_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // Where the window has to be for the contact to go on.
  [[nodiscard]] std::optional<Vec3> remembered(const Vec3& hip_W) const noexcept {
    return in_contact_ ? std::optional<Vec3>(plane().nearest(hip_W)) : std::nullopt;
  }
  [[nodiscard]] ContactPlane plane() const noexcept { return {surface_.p_W, surface_.normal_W, age_ticks_}; }

 private:
  void refreshField(const SampleWindow& window) noexcept;
  [[nodiscard]] Vec3 aim(const Vec3& hip_W) const noexcept;
  [[nodiscard]] Track follow(const Vec3& hip_W, bool ahead) noexcept;
  void comeOut(const Probe& hip, std::uint32_t& faults) noexcept;
  void renew(const Vec3& hip_W, bool ahead, std::uint32_t& faults) noexcept;
  void relocate(const Probe& hip, std::uint32_t& faults) noexcept;
  void moveFreely(const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool touch(const Entry& entry, const Probe& hip, std::uint32_t& faults) noexcept;
  void settle(const SurfacePoint& surface, const Vec3& hip_W) noexcept;
  void release(const Probe& hip) noexcept;

  std::int32_t renewal_ticks_;
  SurfacePoint surface_;  // the plane: its point and normal
  std::int32_t age_ticks_ = 0;
  Vec3 renewed_at_W_ = Vec3::Zero();  // the HIP when the plane was found
  Vec3 vhip_W_ = Vec3::Zero();
  bool in_contact_ = false;  // there is a plane, with the HIP behind it when it was found
  bool held_ = false;        // the last tick could not see the HIP; no force until one can
  std::uint64_t edit_version_ = 0;

  bool armed_ = false;  // free_ was outside, so the way from it to the HIP can be searched for an entry
  Probe free_;          // last HIP known to be outside
  FieldCache cache_;
  const IsoField* field_ = nullptr;  // the cache's, of the window in hand
};

using Hri = VhipAlgorithm<HriSurface>;

}  // namespace palpate
