// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/home_calibration.hpp"

#include <cmath>

#include "base/units.hpp"
#include "servo/devices/one_writer.hpp"

namespace palpate {

void HomeCalibration::beginAnew(bool was_away) noexcept {
  if (was_away) forget();
  state_ = State::kCounts;
  button_ = {};
}

// The arm is told to do so. To count from home takes its calibration away until it does.
HomeCalibration::Order HomeCalibration::order(State state) noexcept {
  state_ = state;
  request_ = heard_ + 1;
  unheard_reports_ = 0;
  if (state == State::kCountingOn) return Order::kCountOn;
  forget();
  return Order::kCountFromHome;
}

HomeCalibration::Answer HomeCalibration::answer(std::uint64_t requests, bool asks, bool is_home) noexcept {
  heard_ = requests;
  const bool is_heard = requests >= request_ && !asks;
  if (state_ == State::kCountingOn && is_heard) state_ = State::kCounts;
  const bool awaits_home = state_ == State::kForgetting || state_ == State::kCalibrating;
  if (!awaits_home || asks || !is_home) return Answer::kNone;
  if (!is_heard) return Answer::kTooEarly;
  if (state_ == State::kCalibrating) {
    calibrated_.store(true, std::memory_order_relaxed);
    countUp(calibrations_);
  }
  state_ = State::kCounts;
  return Answer::kFromHome;
}

HomeCalibration::Order HomeCalibration::look(const Seen& seen, double now_s) noexcept {
  seen_s_ = seen.time_s;
  angles_ = seen.angles;
  notePose(seen.is_possible);
  noteRest(seen);
  return heedButton(seen, now_s);
}

// An arm that is not calibrated knows no poses.
void HomeCalibration::notePose(bool is_possible) noexcept {
  if (is_possible || !isCalibrated()) {
    impossible_poses_ = 0;
    return;
  }
  countUp(impossible_);
  if (++impossible_poses_ >= kImpossible) forget();
}

void HomeCalibration::noteRest(const Seen& seen) noexcept {
  if (!seen.is_elsewhere && way_m(rest_, seen.angles) <= kRest_m) return;
  rest_ = seen.angles;
  rests_since_s_ = seen.time_s;
}

// Each joint moves the handle by its angle times its reach at most. Lengths of arms that are not calibrated are known
// too, their angles are not.
double HomeCalibration::way_m(const Vec3& from, const Vec3& to) const noexcept {
  return (to - from).cwiseAbs().dot(reach_m_);
}

HomeCalibration::Order HomeCalibration::heedButton(const Seen& seen, double now_s) noexcept {
  const bool is_pressed = button_.read(seen.asks, std::llround(seen.time_s * kNanosecondsPerSecond));
  if (!seen.asks) {
    if (state_ == State::kRefused) state_ = State::kCounts;
    unheard_reports_ = 0;
    return Order::kNone;
  }
  if (button_.hasJustChanged()) was_seen_free_ = seen.just_before;
  if (is_pressed) return press(seen.time_s, now_s);
  const bool may_count_on = isFree(now_s) && rests();
  if (state_ == State::kRefused) return may_count_on ? order(State::kCountingOn) : Order::kNone;
  // An order that is not heard is given again, where it may be.
  if (state_ == State::kCounts || ++unheard_reports_ < kAskAgain) return Order::kNone;
  if (state_ == State::kForgetting) return order(state_);
  const bool may = state_ == State::kCountingOn ? may_count_on : whyNot(now_s) == CalibrationRefusal::kNone;
  return may ? order(state_) : Order::kNone;
}

HomeCalibration::Order HomeCalibration::press(double time_s, double now_s) noexcept {
  if (!was_seen_free_) return order(State::kForgetting);
  refusal_ = ask(now_s);
  if (refusal_ == CalibrationRefusal::kNone) return Order::kCountFromHome;
  refused_s_ = time_s;
  state_ = State::kRefused;
  return Order::kNone;
}

CalibrationRefusal HomeCalibration::ask(double now_s) noexcept {
  const CalibrationRefusal why = whyNot(now_s);
  for (std::size_t i = 0; i < kCalibrationRefusals.size(); ++i) {
    if (why == kCalibrationRefusals[i]) countUp(refusals_[i]);
  }
  if (why == CalibrationRefusal::kNone) static_cast<void>(order(State::kCalibrating));
  return why;
}

CalibrationRefusal HomeCalibration::whyNot(double now_s) const noexcept {
  if (!isFree(now_s)) return CalibrationRefusal::kContact;
  if (!rests()) return CalibrationRefusal::kMoving;
  const bool is_away = isCalibrated() && way_m(home_, angles_) > kAtHome_m;
  return is_away ? CalibrationRefusal::kAway : CalibrationRefusal::kNone;
}

CalibrationRefusal HomeCalibration::refusal(double time_s) const noexcept {
  return time_s - refused_s_ < kTold_s ? refusal_ : CalibrationRefusal::kNone;
}

}  // namespace palpate
