// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/avila.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "servo/safety/faults.hpp"

namespace palpate {

void Avila::reset(const Vec3&) noexcept {
  field_.forget();
  ease_.end();
  edit_version_.reset();
}

// depth N needs no square root. Only the normal does, and no later step waits for the normal.
Avila::Push Avila::pushAt(const IsoField& field, const Fetch& f) noexcept {
  Push push;
  const double excess = f.density - field.isovalue();
  if (!(excess > 0)) return push;
  const double steepness_squared = f.gradient_W.squaredNorm();
  if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
    push.faults = bit(ServoFault::kZeroGradient);
    return push;
  }
  // depth N = -excess g / |g|^2
  push.way_W = f.gradient_W * (-excess / steepness_squared);
  const double deepest_m = kDeepest * field.voxel();
  push.normal_W = f.gradient_W * (-1 / std::sqrt(steepness_squared));
  if (excess * excess > deepest_m * deepest_m * steepness_squared) push.way_W = deepest_m * push.normal_W;
  return push;
}

// Old and new volume are compared where the tool was in the last tick, so that its own motion does not count.
void Avila::takeEdit(const IsoField& field, const SampleWindow& window, const Push& here,
                     const Vec3& shown_W) noexcept {
  const bool first = !edit_version_;
  edit_version_ = window.edit_version;
  if (first) return;
  const Fetch f = field.sampler().at(last_hip_W_);
  const Push there = f.place == Place::kBeyondWindow ? here : pushAt(field, f);
  ease_.take(std::max(0.0, shown_W.dot(there.normal_W)), there.way_W.norm());
}

void Avila::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  out.vhip_W = in.hip_W;
  const Vec3 last_way_W = std::exchange(last_way_W_, Vec3::Zero());
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
  Push push = pushAt(field, f);
  out.faults = push.faults;
  if (edit_version_ != in.window->edit_version) takeEdit(field, *in.window, push, last_way_W);
  if (ease_.active()) {
    ease_.elapse(push.way_W.norm());
    push.way_W -= ease_.amount() * push.normal_W;
  }
  last_hip_W_ = in.hip_W;
  last_way_W_ = push.way_W;
  if (push.normal_W.isZero(0)) return;
  out.normal_W = push.normal_W;
  out.vhip_W = in.hip_W + push.way_W;
  out.force_W = stiffness_N_per_m_ * push.way_W - damping_Ns_per_m_ * in.hip_velocity_W;
  out.depth_m = push.way_W.norm();
  out.stored_J = std::numeric_limits<double>::quiet_NaN();
  out.in_contact = true;
}

}  // namespace palpate
