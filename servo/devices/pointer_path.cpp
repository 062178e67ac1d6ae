// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pointer_path.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr double kFarthest_m = 1e6;  // of an aim from the world's origin: nothing that is touched lies there

}  // namespace

// Takes the newest aim, of the newest block.
void PointerPath::look() const noexcept {
  if (PointerAimBlock* const next = next_.load(std::memory_order_acquire); next != nullptr) {
    aims_.emplace(*next);
    next_.store(nullptr, std::memory_order_release);
  }
  if (!aims_ || !aims_->renew()) return;
  const PointerAimRecord next = aims_->front();  // a copy: the other side may write on
  std::atomic_signal_fence(std::memory_order_seq_cst);
  const Vec3 next_W(next.hip_W[0], next.hip_W[1], next.hip_W[2]);
  if (!next_W.allFinite() || next_W.cwiseAbs().maxCoeff() > kFarthest_m) return;
  aim_W_ = next_W;
  until_ = nullptr;
}

// With x the way from the aim and w = 1 / time constant: x(t) = (x0 + (v0 + w x0) t) exp(-w t).
Vec3 PointerPath::position(double time_s) const noexcept {
  const double dt_s = time_s - time_s_;
  if (!(dt_s > 0)) return position_W_;
  time_s_ = time_s;
  look();
  if (until_ != nullptr) {
    const Vec3 before_W = std::exchange(position_W_, until_->position(time_s));
    velocity_W_ = (position_W_ - before_W) / dt_s;
    return position_W_;
  }
  const Vec3& aim_W = aim_W_;
  constexpr double kRate = 1 / kTimeConstant_s;  // [1/s]
  const Vec3 way_W = position_W_ - aim_W;
  const Vec3 slope_W = velocity_W_ + kRate * way_W;
  const double decay = std::exp(-kRate * dt_s);
  const Vec3 next_W = aim_W + decay * (way_W + dt_s * slope_W);
  const Vec3 step_W = next_W - position_W_;
  const double most_m = kFastest_m_per_s * dt_s;
  if (step_W.squaredNorm() > most_m * most_m) {
    position_W_ += step_W * (most_m / step_W.norm());
    velocity_W_ = step_W.normalized() * kFastest_m_per_s;
  } else {
    position_W_ = next_W;
    velocity_W_ = decay * (slope_W - kRate * (way_W + dt_s * slope_W));
  }
  return position_W_;
}

}  // namespace palpate
