// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/implicit.hpp: the surface contact point tracked by its tangent plane, every tick.
//
// Source: Salisbury and Tarr, "Haptic rendering of surfaces defined by implicit functions" (ASME DSC 1997): at each
// instant the tangent plane at the contact point tracks the point's motion. S(p) = tau - density stands for their
// implicit function, positive outside. Each tick: the HIP is projected onto the tangent plane at the last contact
// point, and the projection is brought back to the surface along the gradient (Newton); kPasses times.
// - Contact begins when S says that the HIP is inside, at the first crossing of its way, and ends when S has it
// outside.
//   So a HIP that gets through a wall to the other side is let go, and a stroke that jumps one meets nothing:
//   their S is an equation that is true everywhere, a thin wall in samples is not.
// - S is sampled, so both steps are at most a voxel long; what is farther off the surface than kUsable after the last
//   pass is lost: no force and kSurfaceLost, until the HIP has been outside once. But where an edit has buried the tool
//   or moved the surface away from the contact point, that goes to the nearest way out (IsoField::nearestExit), if
//   there is one in reach.
// - A HIP inside, yet in front of the tangent plane: no force in that tick.
// The isosurface is all that is felt: not the face where an object is cut by the volume's end.
// Frame W: world. Thread: the servo's. Cost: 1 + kPasses fetches in contact. Errors: faults.
#pragma once

#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/free_motion.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class ImplicitSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr int kPasses = 2;        // tangent plane and Newton step [-]
  static constexpr double kUsable = 0.25;  // last Newton step, which is still taken [voxel]

  explicit ImplicitSurface(const AlgorithmParameters& parameters) noexcept : field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] ContactPlane plane() const noexcept { return {p_W_, normal_W_, 0}; }

 private:
  [[nodiscard]] std::uint32_t begin(const IsoField& field, const Entry& entry, const Vec3& hip_W) noexcept;
  [[nodiscard]] std::uint32_t track(const IsoField& field, const Vec3& hip_W) noexcept;
  [[nodiscard]] std::uint32_t ontoSurface(const IsoField& field, const Vec3& x_W, double& residual_m) noexcept;

  FieldCache field_;
  FreeMotion free_;
  Vec3 p_W_ = Vec3::Zero();       // surface contact point
  Vec3 normal_W_ = Vec3::Zero();  // of its tangent plane
  bool in_contact_ = false;
};

using Implicit = VhipAlgorithm<ImplicitSurface>;

}  // namespace palpate
