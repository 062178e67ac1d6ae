// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/avila.hpp"

#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void Avila::reset(const Vec3&) noexcept {
  field_.forget();
}

void Avila::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  out.vhip_W = in.hip_W;
  if (!in.window->usable()) {
    out.faults = bit(ServoFault::kNoWindow);
    return;
  }
  const IsoField& field = field_.of(*in.window);
  const Fetch f = field.sampler().at(in.hip_W);
  if (f.place == Place::kBeyondWindow) {
    out.faults = bit(ServoFault::kBeyondWindow);
    return;
  }
  const double excess = f.density - field.isovalue();
  if (!(excess > 0)) return;
  const double steepness_squared = f.gradient_W.squaredNorm();
  if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
    out.faults = bit(ServoFault::kZeroGradient);
    return;
  }
  // depth N = -excess g / |g|^2: the way to the force needs no root; the normal, which nothing waits for, does.
  Vec3 out_of_object_W = f.gradient_W * (-excess / steepness_squared);
  const double per_steepness = 1 / std::sqrt(steepness_squared);
  const double deepest_m = kDeepest * field.voxel();
  out.normal_W = f.gradient_W * -per_steepness;
  if (excess * excess > deepest_m * deepest_m * steepness_squared) out_of_object_W = deepest_m * out.normal_W;
  out.vhip_W = in.hip_W + out_of_object_W;
  out.force_W = stiffness_N_per_m_ * out_of_object_W - damping_Ns_per_m_ * in.hip_velocity_W;
  out.in_contact = true;
}

}  // namespace palpate
