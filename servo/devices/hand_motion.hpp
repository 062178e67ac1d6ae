// SPDX-License-Identifier: Apache-2.0
// servo/devices/hand_motion.hpp: which ways of a handle a hand can have made: the one law by which a position is
// believed, or taken as a wrong reading, a joint that slipped, or a device that counts from elsewhere.
//
// Speed. A fist that punches has 10 m/s, and no hand that holds a handle is faster.
// Acceleration. A speed grows by at most 1000 m/s^2. A thrower's hand, the quickest there is, reaches some 40 m/s
// within 50 ms, 800 m/s^2; an arm of 0.15 kg that nobody holds is accelerated by its own 5 N with 33 m/s^2. A speed may
// fall at once, and turn: a wall, or a stop of the arm, takes all of it, and gives no more than it took. So in the time
// T after a way of mean speed v in the time T_last a way may have min(10 m/s, v + a (T_last + T) / 2) T. v is the
// largest mean speed of the last moments: the time of one report is not known well. What this lets pass: at 1000
// reports a second a slip of a millimetre from rest where each report's time is known (simulated clock), of 3 mm where
// it is known to a report's time, and more while the hand moves fast, or after a gap between reports.
//
// Times. A position was true at some time between the asking for it and its arrival. `time_s` is the time from one
// arrival to the next, `waited_s` how much older than its arrival the earlier one may have been. A long way says that
// the later one was true late: it has waited the less. So ways do not gain by that again and again.
// Units: m, s. Frame: none; a scene that is larger than the device by a factor has bounds as much larger. One thread.
// Cost: some 5 ns. Errors, heap: none.
#pragma once

#include <algorithm>
#include <limits>

namespace palpate {

struct MotionBounds {
  double speed_m_per_s = 1000;       // usual: paths and recordings may be anything, in a scene of any size
  double acceleration_m_per_s2 = 0;  // by which a speed grows; 0: no bound
};

inline constexpr MotionBounds kHandMotion = {.speed_m_per_s = 10, .acceleration_m_per_s2 = 1000};

class MotionLaw {
 public:
  // `resolution_m`: of positions.
  MotionLaw(const MotionBounds& bounds, double resolution_m) noexcept
      : bounds_(bounds), rounding_m_(kRounding * resolution_m) {
    begin();
  }

  // The next position is the first of which anything is known: the hand may be moving already.
  void begin() noexcept {
    older_m_per_s_ = bounds_.speed_m_per_s;
    newer_m_per_s_ = since_s_ = last_s_ = 0;
    most_waited_s_ = std::numeric_limits<double>::infinity();
  }

  // The longest way from the last position that was believed [m].
  [[nodiscard]] double longestWay_m(double time_s, double waited_s) const noexcept {
    const double within_s = time_s + std::min(waited_s, most_waited_s_);
    double speed = bounds_.speed_m_per_s;
    if (bounds_.acceleration_m_per_s2 > 0) {
      const double recent = std::max(older_m_per_s_, newer_m_per_s_);
      speed = std::min(speed, recent + bounds_.acceleration_m_per_s2 * (last_s_ + within_s) / 2);
    }
    return speed * within_s + rounding_m_;
  }

  // A position that is believed, so far from the last.
  void believe(double way_m, double time_s, double waited_s) noexcept {
    const double within_s = time_s + std::min(waited_s, most_waited_s_);
    most_waited_s_ = std::max(0.0, within_s - way_m / bounds_.speed_m_per_s);
    last_s_ = time_s;
    if (time_s <= 0) return;
    newer_m_per_s_ = std::max(newer_m_per_s_, (way_m + rounding_m_) / time_s);
    since_s_ += time_s;
    if (since_s_ < kRecent_s / 2) return;
    older_m_per_s_ = newer_m_per_s_;
    newer_m_per_s_ = since_s_ = 0;
  }

 private:
  // A reading is off by half a count of each of three encoders, and far out a count is up to twice as long: two
  // readings are off by 2 sqrt(3) of the stated resolution.
  static constexpr double kRounding = 4;
  static constexpr double kRecent_s = 0.02;  // the last moments: from half of it on

  MotionBounds bounds_;
  double rounding_m_;
  double older_m_per_s_ = 0, newer_m_per_s_ = 0;  // largest mean speeds of the last whole half, and of the present one
  double since_s_ = 0;                            // the present half's begin
  double most_waited_s_ = 0;                      // of the last position, as its way says
  double last_s_ = 0;                             // from the position before the last to the last
};

}  // namespace palpate
