// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/avila.hpp: stiffness and motion-retarding force from the density field alone, without a VHIP.
//
// Source: Avila and Sobierajski, "A haptic interaction method for volume visualization" (Visualization 1996): the force
// is a stiffness force along the normal and a retarding force against the motion, both read from the density at the
// HIP, since "for small penetration distances, the density field itself can give a reasonable approximation of the
// distance to an isosurface" (as the paper puts it in section 2.2). They leave the transfer functions to the user. Here
//   depth = (rho - tau) / |grad|, F = K depth N - B v above tau, nothing at or below it:
// the linear estimate of the distance, so that K and B mean what they mean for every other algorithm. The retarding
// force opposes motion in every direction, also on the way out, so it may pull.
// Cap: depth counts up to kDeepest. A scanner spreads a boundary over some three voxels; beyond them the density is
// flat, and the quotient of two small numbers says nothing.
// Weaknesses, which are the method's: the shell is penetrable (inside, where the field is flat, there is no force;
// kZeroGradient); behind the middle of a thin wall the force pushes on through it; the depth is as good as the density
// is linear; a start inside is pushed at once.
// Output: VHIP = HIP + depth N, where the surface would be, so that its distance to the true one measures the estimate.
// Frame W: world. Thread: the servo's. Cost: one fetch. Errors: faults.
#pragma once

#include "servo/algorithms/algorithm.hpp"
#include "servo/algorithms/field_cache.hpp"

namespace palpate {

class Avila final : public Algorithm {
 public:
  static constexpr double kDeepest = 3;  // [voxel]

  explicit Avila(const AlgorithmParameters& parameters) noexcept
      : stiffness_N_per_m_(parameters.stiffness_N_per_m),
        damping_Ns_per_m_(parameters.damping_Ns_per_m),
        field_(parameters.isovalue) {}
  void reset(const Vec3& hip_W) noexcept override;
  void tick(const TickInput& in, TickOutput& out) noexcept override;

 private:
  double stiffness_N_per_m_;
  double damping_Ns_per_m_;
  FieldCache field_;
};

}  // namespace palpate
