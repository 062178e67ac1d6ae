// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/haptization.hpp"

#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void Haptization::reset(const Vec3&) noexcept {
  field_.forget();
}

void Haptization::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  out.vhip_W = in.hip_W;
  if (!in.window->usable()) {
    out.faults = bit(ServoFault::kNoWindow);
    return;
  }
  const Fetch f = field_.of(*in.window).sampler().at(in.hip_W);
  if (f.place == Place::kBeyondWindow) {
    out.faults = bit(ServoFault::kBeyondWindow);
    return;
  }
  if (f.place == Place::kBeyondVolume || !std::isfinite(f.density)) return;
  const double steepness_squared = f.gradient_W.squaredNorm();
  const bool sloped = steepness_squared > 0 && std::isfinite(steepness_squared);
  const double steepness = sloped ? std::sqrt(steepness_squared) : 0;
  const TransferFunction::Value felt = transfer_.at(f.density, steepness);
  out.force_W = -felt.viscosity_Ns_per_m * in.hip_velocity_W;
  if (!sloped || felt.force_N == 0) return;
  out.normal_W = f.gradient_W / -steepness;
  out.force_W += felt.force_N * out.normal_W;
  out.in_contact = true;
}

}  // namespace palpate
