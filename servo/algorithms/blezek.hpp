// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/blezek.hpp: the VHIP inched along the isosurface until normal and VHIP-HIP line agree.
//
// Source: Blezek and Robb, as the paper describes it in section 2.2: the VHIP must be chosen such that the surface
// normal there is the direction from the HIP to the VHIP; since that may have solutions on several sheets, the VHIP
// moves there from where it was, in small steps along the surface. What is left open is chosen here:
// - On entry the VHIP is the first crossing of the HIP's way. Contact ends when the HIP is in front of the VHIP.
// - An inch: density and gradient at the VHIP (one fetch), a Newton step along the gradient onto the isosurface, and,
//   unless aligned, a step of at most kInch along the tangent plane towards the HIP, shorter near the goal.
// - The inch and the alignment are the loosest, and so the cheapest, that cost no accuracy. On a ball of 20 voxels and
//   a knot whose tube has 4, 1 voxel deep at 0.1 m/s, an alignment of 5e-3 takes 3 fetches a tick and gives the normal
//   within 0.015 and 0.325 degrees in the median; 2e-2 takes 2 and gives 0.019 and 0.359, 2e-4 takes 4 to 5 and gives
//   0.015 and 0.321. Inches of 1, 0.5, 0.25 and 0.1 voxel give the same to the third digit, and none of them loses the
//   surface of a noisy tube of 1.5 voxels at 1 m/s; they differ in cost from 0.25 m/s on.
// - Out of inches the VHIP stays where it has come to, on the surface, and goes on in the next tick.
// - Lost: no gradient, or farther from the isosurface than one voxel by the linear estimate, or led out of the window
//   that holds the HIP. Then there is no force, "effectively rendering the object haptically transparent", and
//   kSurfaceLost, until the HIP has been outside once. But where an edit has buried the tool or moved the surface away
//   from the VHIP, the VHIP goes to the nearest way out (IsoField::nearestExit), if there is one in reach.
// The isosurface is all that is felt: not the face where an object is cut by the volume's end.
// Frame W: world. Thread: the servo's. Cost: one fetch per inch, at most kMaxInches + 1. Errors: faults.
#pragma once

#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/free_motion.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class BlezekSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr double kInch = 0.5;        // [voxel]
  static constexpr double kAlignment = 5e-3;  // tangent of the angle between normal and VHIP-HIP line: 0.29 degrees
  static constexpr double kOnSurface = 0.01;  // the last Newton step, which is still taken, is this short [voxel]
  static constexpr int kMaxInches = 8;        // a tick: 4 voxels of way

  explicit BlezekSurface(const AlgorithmParameters& parameters) noexcept : field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] ContactPlane plane() const noexcept { return {vhip_W_, normal_W_, 0}; }

 private:
  // False: the surface is lost.
  [[nodiscard]] bool inchAlong(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] bool comeOut(const IsoField& field, const Probe& hip, std::uint32_t& faults) noexcept;
  void release(const Probe& hip) noexcept;

  FieldCache field_;
  FreeMotion free_;
  Vec3 vhip_W_ = Vec3::Zero();
  Vec3 normal_W_ = Vec3::Zero();
  bool in_contact_ = false;
};

using Blezek = VhipAlgorithm<BlezekSurface>;

}  // namespace palpate
