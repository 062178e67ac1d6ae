// SPDX-License-Identifier: Apache-2.0
// servo/loop/velocity_filter.hpp: the servo's velocity: backward difference, then a first-order low-pass.
//
//   v += a ((x - x_last) / dt - v),  a = 1 - exp(-2 pi f_c dt),
// the exact discretisation of a low-pass of cutoff f_c [Hz] for an input that is held over a tick. Its delay is dt / 2
// + 1 / (2 pi f_c). dt is the time since the last position: one tick, or several after missed deadlines.
// Frame W: world [m, m/s]. Thread: the servo's. Cost: some 5 ns. Errors: none.
#pragma once

#include <cmath>

#include "base/vec.hpp"

namespace palpate {

class VelocityFilter {
 public:
  // `cutoff_hz` 0 or less: no low-pass, the bare backward difference.
  VelocityFilter(double cutoff_hz, double rate_hz) noexcept
      : rate_hz_(rate_hz), keep_per_tick_(cutoff_hz > 0 ? std::exp(-2 * M_PI * cutoff_hz / rate_hz) : 0.0) {}

  // Starts at rest at `position_W` [m].
  void reset(const Vec3& position_W) noexcept {
    last_W_ = position_W;
    velocity_W_.setZero();
  }

  // `ticks`: grid periods since the last position, at least 1.
  [[nodiscard]] const Vec3& update(const Vec3& position_W, int ticks) noexcept {
    const double keep = ticks == 1 ? keep_per_tick_ : std::pow(keep_per_tick_, ticks);
    const Vec3 difference_W = (position_W - last_W_) * (rate_hz_ / ticks);
    velocity_W_ += (1 - keep) * (difference_W - velocity_W_);
    last_W_ = position_W;
    return velocity_W_;
  }

 private:
  double rate_hz_;
  double keep_per_tick_;
  Vec3 last_W_ = Vec3::Zero();
  Vec3 velocity_W_ = Vec3::Zero();
};

}  // namespace palpate
