// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/haptization.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "servo/safety/faults.hpp"

namespace palpate {

void Haptization::reset(const Vec3&) noexcept {
  field_.forget();
  ease_force_.end();
  ease_viscosity_.end();
  edit_version_.reset();
}

Haptization::Felt Haptization::feltAt(const Fetch& f) const noexcept {
  Felt felt;
  if (f.place == Place::kBeyondVolume || !std::isfinite(f.density)) return felt;
  const double steepness_squared = f.gradient_W.squaredNorm();
  const bool sloped = steepness_squared > 0 && std::isfinite(steepness_squared);
  const double steepness = sloped ? std::sqrt(steepness_squared) : 0;
  const TransferFunction::Value value = transfer_.at(f.density, steepness);
  felt.viscosity_Ns_per_m = value.viscosity_Ns_per_m;
  if (!sloped || value.force_N == 0) return felt;
  felt.force_N = value.force_N;
  felt.normal_W = f.gradient_W / -steepness;
  return felt;
}

// Old and new volume are compared where the tool was in the last tick, so that its own motion does not count.
void Haptization::takeEdit(const IsoField& field, const SampleWindow& window, const Felt& here,
                           const Felt& shown) noexcept {
  const bool first = !edit_version_;
  edit_version_ = window.edit_version;
  if (first) return;
  const Fetch f = field.sampler().at(last_hip_W_);
  const Felt there = f.place == Place::kBeyondWindow ? here : feltAt(f);
  const double along_N = shown.push_W().dot(std::copysign(1.0, there.force_N) * there.normal_W);
  ease_force_.take(std::max(0.0, along_N), std::abs(there.force_N));
  ease_viscosity_.take(shown.viscosity_Ns_per_m, there.viscosity_Ns_per_m);
}

void Haptization::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  out.vhip_W = in.hip_W;
  const Felt shown = std::exchange(last_, Felt{});
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
  Felt felt = feltAt(f);
  if (edit_version_ != in.window->edit_version) takeEdit(field, *in.window, felt, shown);
  if (ease_force_.active()) {
    ease_force_.elapse(std::abs(felt.force_N));
    felt.force_N -= std::copysign(ease_force_.amount(), felt.force_N);
  }
  if (ease_viscosity_.active()) {
    ease_viscosity_.elapse(felt.viscosity_Ns_per_m);
    felt.viscosity_Ns_per_m -= ease_viscosity_.amount();
  }
  last_hip_W_ = in.hip_W;
  last_ = felt;
  out.force_W = felt.push_W() - felt.viscosity_Ns_per_m * in.hip_velocity_W;
  out.normal_W = felt.normal_W;
  out.in_contact = !felt.normal_W.isZero(0);
  if (out.in_contact) out.depth_m = out.stored_J = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate
