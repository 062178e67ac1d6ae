// SPDX-License-Identifier: Apache-2.0
// servo/loop/foaw.hpp: velocity by first-order adaptive windowing, end-fit (Janabi-Sharifi, Hayward, Chen 2000).
//
// Along each axis the velocity is the slope of the line from a past position to the newest one. The window is the
// longest for which the line passes every position in between within the noise bound d:
//   v = (x_k - x_{k-n}) / (t_k - t_{k-n}),  |x_{k-i} - (x_k - v (t_k - t_{k-i}))| <= d  for 0 < i < n.
// Slow motion gets a long window and a quiet velocity. Sudden motion gets a window of one tick and no delay. Positions
// that are rounded to multiples of Delta err by Delta / 2 each. So on a straight motion d = Delta never shortens the
// window, and the velocity errs by at most Delta / (n T). With d = 0 the result is the backward difference, except for
// motion that is exactly straight.
// The paper tests every line against every position: n^2 / 2 tests. Here each position narrows the interval of slopes
// that pass it within d. The slope of the next line must lie in the interval that is left. That gives the same answer
// after n tests.
// Ticks without a position (missed deadlines, a slow device) count as time that passed; the window is bounded in time.
// Frame W: world [m, m/s]. Thread: the servo's. Cost: some 2 ns for each axis and position in the window, 100 ns for 16
// of them; no heap.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "base/vec.hpp"

namespace palpate {

class Foaw {
 public:
  static constexpr int kMostTicks = 32;

  // `noise_m`: d, 0 or more [m]; `window_ticks`: longest window, cut to 1 .. kMostTicks [tick].
  Foaw(double noise_m, int window_ticks, double rate_hz) noexcept
      : noise_m_(noise_m), window_ticks_(std::clamp(window_ticks, 1, kMostTicks)), rate_hz_(rate_hz) {}

  // Starts at rest at `position_W` [m] and forgets what was before.
  void reset(const Vec3& position_W) noexcept {
    tick_ = 0;
    count_ = newest_ = 0;
    push(position_W);
  }

  // `ticks`: grid periods since the last position, at least 1. Gives [m/s].
  [[nodiscard]] Vec3 update(const Vec3& position_W, int ticks) noexcept {
    tick_ += ticks;
    push(position_W);
    Vec3 velocity_W;
    for (int axis = 0; axis < 3; ++axis) velocity_W[axis] = slope(axis) * rate_hz_;
    return velocity_W;
  }

 private:
  static constexpr int kSize = kMostTicks + 1;  // a window of n ticks has n + 1 positions at most
  struct Entry {
    Vec3 position_W = Vec3::Zero();
    std::int64_t tick = 0;
  };

  void push(const Vec3& position_W) noexcept {
    newest_ = newest_ + 1 < kSize ? newest_ + 1 : 0;
    entries_[static_cast<std::size_t>(newest_)] = {position_W, tick_};
    if (count_ < kSize) ++count_;
  }

  // The velocity along one axis [m/tick]; 0 while there is one position only.
  [[nodiscard]] double slope(int axis) const noexcept {
    const double now_m = entries_[static_cast<std::size_t>(newest_)].position_W[axis];
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    double best = 0;
    int at = newest_;
    for (int n = 1; n < count_; ++n) {
      at = at > 0 ? at - 1 : kSize - 1;
      const Entry& past = entries_[static_cast<std::size_t>(at)];
      const std::int64_t span = tick_ - past.tick;
      if (n > 1 && span > window_ticks_) break;
      const double per_tick = 1 / static_cast<double>(span);
      const double to_here = (now_m - past.position_W[axis]) * per_tick;
      if (!(to_here >= lowest && to_here <= highest)) break;
      best = to_here;
      lowest = std::max(lowest, to_here - noise_m_ * per_tick);
      highest = std::min(highest, to_here + noise_m_ * per_tick);
    }
    return best;
  }

  double noise_m_;
  int window_ticks_;
  double rate_hz_;
  std::array<Entry, kSize> entries_{};
  int newest_ = 0;
  int count_ = 0;
  std::int64_t tick_ = 0;  // since reset()
};

}  // namespace palpate
