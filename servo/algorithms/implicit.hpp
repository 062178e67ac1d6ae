// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/implicit.hpp: a surface contact point, tracked by its tangent plane every tick.
//
// Source: Salisbury and Tarr, "Haptic rendering of surfaces defined by implicit functions" (ASME DSC 1997): at each
// instant the tangent plane at the contact point tracks the point's motion. S(p) = tau - density stands for their
// implicit function, positive outside. A pass projects the HIP onto the tangent plane at the last contact point, and
// brings the projection back to the surface along the gradient (Newton). Each tick makes kPasses, and up to
// kSettlePasses while they still move the point along the plane.
// - Contact begins when S says that the HIP is inside, at the first crossing of the HIP's path. So a stroke that jumps
//   a wall meets nothing. From then on the tangent plane decides: it is there "to track the contact point's motion and
//   prevent it from passing though the surface" (their abstract). Contact ends when the HIP is in front of the plane
//   and S has the HIP outside. So a HIP that gets through a wall is held, and one in a hole that noise makes in the
//   object too. If the HIP is inside but in front of the plane, there is no force in that tick.
// - S is sampled, so both steps are at most a voxel long. Passes go on, up to kMaxPasses, while the projection was cut
//   short or the last Newton step was longer than kUsable. If none ends well, the pass that came nearest to the surface
//   is used.
// - While the window does not hold the contact point, the contact is remembered, without force (kBeyondWindow). The HIP
//   may be anywhere.
// - The contact is lost if there is no gradient, if no pass came within a voxel of the surface, or if the passes led
//   out of the volume. Then there is no force and kSurfaceLost, until the HIP has been outside once. An exception is an
//   edit that has buried the tool or moved the surface away from the contact point. Then that point goes to the nearest
//   way out (IsoField::nearestExit), if there is one in reach.
// A voxel is the smallest spacing. Only the isosurface is felt, not the face where the volume's end cuts an object.
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
  static constexpr int kPasses = 2;  // per tick, each of a projection and a Newton step
  static constexpr int kSettlePasses =
      4;  // at most, while a pass moves the point along the plane by more than kSettled
  static constexpr double kSettled = 0.05;  // [voxel]
  static constexpr int kMaxPasses = 16;     // at most, until the projection is whole and the Newton step within kUsable
  static constexpr double kUsable = 0.25;   // longest last Newton step; it is taken [voxel]

  explicit ImplicitSurface(const AlgorithmParameters& parameters) noexcept : field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept;
  void resume(const Vec3& free_W) noexcept { free_.resume(free_W); }
  bool find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept;
  // The surface point that the window must hold for the contact to go on.
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
