// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/blezek.hpp: moves the VHIP in inches along the isosurface until normal and VHIP-HIP line agree.
//
// Source: Blezek and Robb, as the paper describes it in section 2.2. At the VHIP, the surface normal is the direction
// from the HIP to the VHIP. Several sheets may have such a point. So the VHIP moves there from where it was, in small
// steps along the surface. What the paper leaves open is chosen here:
// - On entry the VHIP is the first crossing of the HIP's path. Contact ends when the HIP is in front of the VHIP's
//   tangent plane and outside the object. If the HIP is in front of that plane but inside (noise, a ridge), there is no
//   force in that tick.
// - An inch is a step of at most kInch along the tangent plane towards the HIP, one fetch of density and gradient
//   there, and a Newton step of at most a voxel along the gradient onto the isosurface. Each tick begins with the slide
//   along the plane of the last tick. So a tick that is aligned at once takes one fetch.
// - Inches go on until normal and VHIP-HIP line agree. A tick has kSettleInches for that, and further inches for the
//   lateral motion of the HIP. If they do not suffice, the inch that came nearest to the isosurface is used, and the
//   next tick goes on from there.
// - Order, inch and tolerances are the cheapest that cost no accuracy. Fetches a tick and median angle, measured on
//   phantom:sphere and phantom:knot of 64^3, 1 voxel deep, 0.1 m/s:
//     climb first, alignment 5e-3   2.0 and 3.3, 0.016 and 0.364 degrees
//     slide first, alignment 5e-3   1.0 and 2.3, 0.016 and 0.364 (chosen)
//     slide first, 2e-3             2.0 and 2.8, 0.012 and 0.362; without end 0.012 and 0.360
//     slide first, 2e-2             1.0 and 1.5, 0.016 and 0.390
//   A kOnSurface of 1e-3 takes 0.4 fetches more on the sphere and changes nothing. Inches of 0.25 to 2 voxels give the
//   same here. At 1 m/s inches of 0.25 need half as many fetches again as those of 0.5. In noise of half a voxel,
//   inches of 1 and 2 lost the surface of a tube of 8 voxels. At 1 m/s three settling inches give 0.371 degrees and two
//   0.444; four and eight give 0.346.
// - While the window does not hold the VHIP, the contact is remembered, without force (kBeyondWindow). The HIP may be
//   anywhere.
// - The contact is lost if there is no gradient, if no inch came within a voxel of the isosurface by the linear
//   estimate, or if the inches led out of the volume. Then there is no force, "effectively rendering the object
//   haptically transparent", and kSurfaceLost, until the HIP has been outside once. An exception is an edit that has
//   buried the tool or moved the surface away from the VHIP. Then the VHIP goes to the nearest way out
//   (IsoField::nearestExit), if there is one in reach.
// A voxel is the smallest spacing. Only the isosurface is felt, not the face where the volume's end cuts an object.
// Frame W: world. Thread: the servo's. Cost: one fetch per inch, at most kMaxInches. Errors: faults.
#pragma once

#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/free_motion.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class BlezekSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr double kInch = 0.5;        // [voxel]
  static constexpr double kAlignment = 5e-3;  // tangent of the largest angle between normal and line: 0.29 degrees
  // A longer VHIP-HIP line counts as this long for the angle: the line misses by at most 0.02 voxel [voxel].
  static constexpr double kLongestLever = 4;
  static constexpr double kOnSurface = 0.01;  // the last Newton step is at most this long; it is taken [voxel]
  static constexpr int kSettleInches = 4;     // per tick, besides those for the HIP's lateral motion
  static constexpr int kMaxInches = 40;       // per tick in all: a path of 20 voxels

  explicit BlezekSurface(const AlgorithmParameters& parameters) noexcept : field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  void resume(const Vec3& free_W) noexcept { free_.resume(free_W); }
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // The surface point that the window must hold for the contact to go on.
  [[nodiscard]] std::optional<Vec3> remembered(const Vec3&) const noexcept {
    return in_contact_ ? std::optional<Vec3>(vhip_W_) : std::nullopt;
  }
  [[nodiscard]] ContactPlane plane() const noexcept { return {vhip_W_, normal_W_, 0}; }

 private:
  enum class Inching { kThere, kBeyondWindow, kLost };
  // Moves VHIP and normal towards the aligned point, as far as the surface can be followed.
  [[nodiscard]] Inching inchAlong(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] Inching takeNearestExit(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  void begin(const Entry& entry, const Vec3& hip_W) noexcept;
  void release(const Probe& hip) noexcept;

  FieldCache field_;
  FreeMotion free_;
  Vec3 vhip_W_ = Vec3::Zero();
  Vec3 normal_W_ = Vec3::Zero();
  bool in_contact_ = false;
  bool edited_ = false;  // since the VHIP was last on the surface
};

using Blezek = VhipAlgorithm<BlezekSurface>;

}  // namespace palpate
