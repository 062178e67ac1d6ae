// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/implicit.hpp: the surface contact point tracked by its tangent plane, every tick.
//
// Source: Salisbury and Tarr, "Haptic rendering of surfaces defined by implicit functions" (ASME DSC 1997): at each
// instant the tangent plane at the contact point tracks the point's motion. S(p) = tau - density stands for their
// implicit function, positive outside. Each tick: the HIP is projected onto the tangent plane at the last contact
// point, and the projection is brought back to the surface along the gradient (Newton); kPasses times, and up to
// kSettlePasses while that still moves the point along the plane.
// - Contact begins when S says that the HIP is inside, at the first crossing of its way: a stroke that jumps a wall
//   meets nothing. From then on the tangent plane holds, as it is there "to track the contact point's motion and
//   prevent it from passing though the surface" (their abstract): contact ends when the HIP is in front of it and S has
//   the HIP outside. So a HIP that gets through a wall, or into a hole that noise makes in the object, is held. A HIP
//   inside, yet in front of the plane: no force in that tick.
// - S is sampled, so both steps are at most a voxel long. Passes go on, up to kMaxPasses, while the projection was cut
//   short or the last Newton step was longer than kUsable; then the pass that came nearest to the surface stands.
// - The contact is remembered while the window does not hold the contact point (no force, kBeyondWindow); the HIP may
//   be anywhere.
// - Lost: no gradient, no pass came within a voxel of the surface, or they led out of the volume: no force and
//   kSurfaceLost, until the HIP has been outside once. But where an edit has buried the tool or moved the surface away
//   from the contact point, that goes to the nearest way out (IsoField::nearestExit), if there is one in reach.
// A voxel is the smallest spacing.
// The isosurface is all that is felt: not the face where an object is cut by the volume's end.
// Frame W: world. Thread: the servo's. Cost: kPasses to kSettlePasses fetches in contact, at most kMaxPasses. Errors:
// faults.
#pragma once

#include "servo/algorithms/field_cache.hpp"
#include "servo/algorithms/free_motion.hpp"
#include "servo/algorithms/vhip_algorithm.hpp"

namespace palpate {

class ImplicitSurface {
 public:
  static constexpr bool kMayPull = false;
  static constexpr int kPasses = 2;         // tangent plane and Newton step [-]
  static constexpr int kSettlePasses = 4;   // while the last one moved the point along the plane by more than
  static constexpr double kSettled = 0.05;  // [voxel]
  static constexpr int kMaxPasses = 16;     // until the HIP's way is gone and the last Newton step, which is still
  static constexpr double kUsable = 0.25;   // taken, was this short [voxel]

  explicit ImplicitSurface(const AlgorithmParameters& parameters) noexcept : field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // Where the window has to be for the contact to go on.
  [[nodiscard]] std::optional<Vec3> remembered(const Vec3&) const noexcept {
    return in_contact_ ? std::optional<Vec3>(p_W_) : std::nullopt;
  }
  [[nodiscard]] ContactPlane plane() const noexcept { return {p_W_, normal_W_, 0}; }

 private:
  enum class Tracking { kThere, kBeyondWindow, kLost };
  [[nodiscard]] Tracking begin(const IsoField& field, const Entry& entry, const Vec3& hip_W,
                               std::uint32_t& faults) noexcept;
  [[nodiscard]] Tracking track(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  [[nodiscard]] Tracking ontoSurface(const IsoField& field, const Vec3& x_W, double& residual_m,
                                     std::uint32_t& faults) noexcept;
  void release(const Probe& hip) noexcept;

  FieldCache field_;
  FreeMotion free_;
  Vec3 p_W_ = Vec3::Zero();       // surface contact point
  Vec3 normal_W_ = Vec3::Zero();  // of its tangent plane
  bool in_contact_ = false;
  bool edited_ = false;  // since the contact point was last on the surface
};

using Implicit = VhipAlgorithm<ImplicitSurface>;

}  // namespace palpate
