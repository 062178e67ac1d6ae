// SPDX-License-Identifier: Apache-2.0
// servo/safety/encoder_position.hpp: estimates the tool's position from encoder readings, which are multiples of Delta.
//
// Sums of force times displacement must not use the reading x_hat itself. When x_hat advances by one step, the tool has
// just crossed the edge between two steps. It did not move from the middle of one step to the middle of the next. A sum
// over x_hat would let the force of the old step act over half of the new one, on the way in and on the way out. So
// each step would add an energy of K Delta^2 / 2 that nobody received. The estimate x~ avoids that. Along each axis
//   x~ = the edge that was crossed + half of the motion of a tick, but no further than the middle of the step.
// The motion of a tick is the reading's last change, divided by the ticks that it took. A slow tool is at the edge. A
// tool that crosses a step or more in each tick is in the middle on average. While the reading stays, so does x~.
// x~ and the true x lie in the same step, so |x~ - x| <= Delta. With Delta = 0, x~ = x_hat.
// Frame: that of the readings [m]. Thread: the servo's. Cost: 3 ns. Errors, heap: none.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec.hpp"

namespace palpate {

class EncoderPosition {
 public:
  explicit EncoderPosition(double resolution_m) noexcept : resolution_m_(resolution_m) {}

  void reset(const Vec3& reading) noexcept {
    reading_ = position_ = reading;
    ticks_.setConstant(kAtRest_ticks);
  }

  // A new reading, `ticks` ticks of the servo after the last one.
  void read(const Vec3& reading, int ticks) noexcept {
    if (!(resolution_m_ > 0)) {
      position_ = reading;
      return;
    }
    for (int i = 0; i < 3; ++i) {
      ticks_[i] += ticks;
      const double change_m = reading[i] - reading_[i];
      if (change_m == 0) continue;
      const double way_m = std::min(std::abs(change_m) / ticks_[i], resolution_m_);  // motion of a tick [m]
      position_[i] = reading[i] - std::copysign((resolution_m_ - way_m) / 2, change_m);
      ticks_[i] = 0;
    }
    reading_ = reading;
  }

  [[nodiscard]] const Vec3& value() const noexcept { return position_; }  // x~

 private:
  static constexpr double kAtRest_ticks = 1e6;

  double resolution_m_;
  Vec3 reading_ = Vec3::Zero();
  Vec3 position_ = Vec3::Zero();
  Vec3 ticks_ = Vec3::Constant(kAtRest_ticks);  // since the reading last changed, along each axis
};

}  // namespace palpate
