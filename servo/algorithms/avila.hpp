// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/avila.hpp: stiffness and motion-retarding force from the density field alone, without a VHIP.
//
// Source: Avila and Sobierajski, "A haptic interaction method for volume visualization" (Visualization 1996). They add
// a stiffness force along the normal and a retarding force against the motion. Both are read from the density at the
// HIP: "for small penetration distances, the density field itself can give a reasonable approximation of the distance
// to an isosurface" (the paper, section 2.2). They leave the transfer functions to the user. Here
//   depth = (rho - tau) / |grad|, F = K depth N - B v above tau, nothing at or below it.
// This is the linear estimate of the distance, so K and B mean what they mean for every other algorithm. The retarding
// force opposes motion in every direction, also on the way out, so it may pull.
// Cap: depth counts up to kDeepest. A scanner spreads a boundary over some three voxels. Beyond them the density is
// flat, and the quotient of two small numbers says nothing.
// The method's weaknesses:
// - The shell is penetrable. Inside, where the field is flat, there is no force (kZeroGradient).
// - Behind the middle of a thin wall the force pushes on through it.
// - The depth is only as good as the density is linear.
// - A tool that starts inside is pushed at once.
// Edits. An edit adds depth at the place where the tool was when the edit came. That depth is taken in over time
// (edit_ease.hpp). Depth that an edit takes away is gone at once. So a tool that an edit buries is pushed out gently
// where the density slopes. In flat density it is not pushed (kZeroGradient).
// Output: VHIP = HIP + depth N, the estimated surface point. Its distance from the true surface is the error of the
// estimate.
// Frame W: world. Thread: the servo's. Cost: one fetch, one more with an edit. Errors: faults.
#pragma once

#include <optional>

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"
#include "servo/contact/edit_ease.hpp"

namespace palpate {

class Avila final : public Algorithm {
 public:
  static constexpr double kDeepest = 3;  // [voxel]

  explicit Avila(const AlgorithmParameters& parameters) noexcept
      : stiffness_N_per_m_(parameters.stiffness_N_per_m),
        damping_Ns_per_m_(parameters.damping_Ns_per_m),
        ease_(parameters.rate_hz),
        field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept override;
  void tick(const TickInput& in, TickOutput& out) noexcept override;

 private:
  struct Push {
    Vec3 way_W = Vec3::Zero();     // depth N, out of the object [m]
    Vec3 normal_W = Vec3::Zero();  // zero: no push
    std::uint32_t faults = 0;
  };
  [[nodiscard]] static Push pushAt(const IsoField& field, const Fetch& f) noexcept;
  void takeEdit(const IsoField& field, const SampleWindow& window, const Push& here, const Vec3& shown_W) noexcept;

  double stiffness_N_per_m_;
  double damping_Ns_per_m_;
  EditEase ease_;  // of the depth [m]
  std::optional<std::uint64_t> edit_version_;
  Vec3 last_hip_W_ = Vec3::Zero();
  Vec3 last_way_W_ = Vec3::Zero();  // depth N as shown in the last tick [m]
  FieldCache field_;
};

}  // namespace palpate
