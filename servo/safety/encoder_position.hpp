// SPDX-License-Identifier: Apache-2.0
// servo/safety/encoder_position.hpp: where the tool was when its encoders, which round to multiples of Delta, read
// x_hat.
//
// For sums of force times way, x_hat itself is a bad answer: an encoder that goes one step on says that the tool has
// just crossed the edge between two steps, not that it went from the middle of one to the middle of the next. A sum
// over x_hat makes the force of the old step act over half of the new one, on the way in and on the way out, and so
// finds K Delta^2 / 2 a step that nobody got. Here, along each axis,
//   x~ = edge that was crossed + half of the way of a tick, but no further than the middle of the step,
// where the way of a tick is the reading's change over the ticks since it last changed. A slow tool is at the edge, one
// that crosses a step or more a tick is in the middle on average. While the reading stays, so does x~.
// x~ and x lie in the same step, so |x~ - x| <= Delta, always. Delta = 0: x~ = x_hat.
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
      const double way_m = std::min(std::abs(change_m) / ticks_[i], resolution_m_);  // of a tick
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
