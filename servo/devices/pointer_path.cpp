// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/pointer_path.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

constexpr double kFarthest_m = 1e6;  // of an aim from the world's origin: nothing that is touched lies there

bool isPlace(const Vec3& p_W) noexcept {
  return p_W.allFinite() && p_W.cwiseAbs().maxCoeff() <= kFarthest_m;
}

}  // namespace

void PointerAim::aim(const PointerTarget& target) noexcept {
  for (int axis = 0; axis < 3; ++axis) newest_.hip_W[axis] = target.hip_W[axis];
  if (target.from_W) {
    for (int axis = 0; axis < 3; ++axis) newest_.from_W[axis] = (*target.from_W)[axis];
    ++newest_.leaps;
  }
  aims_.back() = newest_;
  aims_.publish();
}

std::optional<PointerTarget> PointerTargets::take() noexcept {
  if (!aims_.renew()) return std::nullopt;
  const PointerAimRecord next = aims_.front();  // a copy: the other side may write on
  std::atomic_signal_fence(std::memory_order_seq_cst);
  PointerTarget target(Vec3(next.hip_W[0], next.hip_W[1], next.hip_W[2]));
  if (!isPlace(target.hip_W)) return std::nullopt;
  if (next.leaps != leaps_) {
    const Vec3 from_W(next.from_W[0], next.from_W[1], next.from_W[2]);
    if (!isPlace(from_W)) return std::nullopt;
    leaps_ = next.leaps;
    target.from_W = from_W;
  }
  return target;
}

// Takes the newest aim, of the newest block.
bool PointerPath::look() const noexcept {
  if (PointerAimBlock* const next = next_.load(std::memory_order_acquire); next != nullptr) {
    targets_.emplace(*next);
    next_.store(nullptr, std::memory_order_release);
  }
  const std::optional<PointerTarget> target = targets_ ? targets_->take() : std::nullopt;
  if (!target) return false;
  aim_W_ = target->hip_W;
  until_ = nullptr;
  if (!target->from_W) return false;
  ++leaps_;
  position_W_ = *target->from_W;
  velocity_W_.setZero();
  return true;
}

// With x the way from the aim and w = 1 / time constant: x(t) = (x0 + (v0 + w x0) t) exp(-w t).
Vec3 PointerPath::position(double time_s) const noexcept {
  const double dt_s = time_s - time_s_;
  if (!(dt_s > 0)) return position_W_;
  time_s_ = time_s;
  if (look()) return position_W_;  // the first tick there is at rest
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
