// SPDX-License-Identifier: Apache-2.0
#include "servo/devices/motor_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

double halfSine(double time_s) noexcept {
  return std::sin(std::numbers::pi * time_s / MotorCheck::kPush_s);
}

}  // namespace

// The mean way of the handle over a push, of an arm that nobody holds.
double MotorCheck::expected_m() const noexcept {
  constexpr double kStep_s = 1e-3;
  double way_m = 0, speed = 0, sum_m = 0;
  int steps = 0;
  for (double t = 0; t < kPush_s; t += kStep_s, ++steps) {
    speed += kStep_s * (halfSine(t + kStep_s / 2) - arm_.damping_Ns_per_m() * speed) / arm_.mass_kg();
    way_m += kStep_s * speed;
    sum_m += way_m;
  }
  return force_N_ * sum_m / steps;
}

bool MotorCheck::isRight() const noexcept {
  return std::all_of(findings_.begin(), findings_.end(),
                     [](const MotorFinding& f) { return f.verdict == MotorFinding::Verdict::kRight; });
}

bool MotorCheck::step(double time_s) noexcept {
  if (motor_ >= 3) return false;
  if (phase_ == Phase::kBegin) {
    phase_ = Phase::kRest;
    begin_s_ = rests_s_ = time_s;
    start_ = arm_.angles();
  }
  phase_ == Phase::kRest ? rest(time_s) : push(time_s);
  return motor_ < 3;
}

void MotorCheck::rest(double time_s) noexcept {
  arm_.push(motor_, 0);
  const Vec3 ways_m = (arm_.angles() - start_).cwiseProduct(arm_.levers_m());
  noise_m_ = time_s - begin_s_ < kQuiet_s ? kQuiet_m : kRest_m;
  if (!arm_.canBeTried() || !(ways_m.cwiseAbs().maxCoeff() <= noise_m_)) {
    start_ = arm_.angles();
    rests_s_ = time_s;
  }
  if (time_s - rests_s_ >= kRest_s) {
    phase_ = Phase::kPush;
    begin_s_ = time_s;
    start_ = arm_.angles();
    levers_m_ = arm_.levers_m();
    sum_.setZero();
    samples_ = 0;
  } else if (time_s - begin_s_ >= kPatience_s) {
    motor_ = 3;  // whoever does not hold it still for one motor does not for the next
  }
}

void MotorCheck::push(double time_s) noexcept {
  const double passed_s = time_s - begin_s_;
  if (phase_ == Phase::kPush && passed_s < kPush_s) {
    sum_ += arm_.angles() - start_;
    ++samples_;
    return arm_.push(motor_, sign_ * force_N_ * halfSine(passed_s));
  }
  phase_ = Phase::kBrake;
  if (passed_s < 2 * kPush_s) return arm_.push(motor_, -sign_ * force_N_ * halfSine(passed_s - kPush_s));
  arm_.push(motor_, 0);
  phase_ = Phase::kBegin;
  const Vec3 mean = sum_ / std::max(1, samples_);
  if (sign_ > 0) {
    answer_ = mean;
    sign_ = -1;
    return;
  }
  answer_ = (answer_ - mean) / 2;
  sign_ = 1;
  judge();
}

void MotorCheck::judge() noexcept {
  using Verdict = MotorFinding::Verdict;
  MotorFinding& finding = findings_[static_cast<std::size_t>(motor_)];
  const Vec3 ways_m = answer_.cwiseProduct(levers_m_);
  ways_m.cwiseAbs().maxCoeff(&finding.joint);
  const bool is_clear =
      std::abs(answer_[finding.joint]) >= kClear_counts * std::abs(arm_.counts_rad()[finding.joint]) &&
      std::abs(ways_m[finding.joint]) >= kClear * noise_m_;
  finding.share = ways_m[finding.joint] / expected_m();
  const bool answers = is_clear && std::abs(finding.share) >= kWeakest;
  if (!answers && force_N_ < kLast_N) {
    force_N_ = std::min(2 * force_N_, kLast_N);
    return;
  }
  if (!is_clear)
    finding.verdict = Verdict::kDead;
  else if (finding.joint != motor_)
    finding.verdict = Verdict::kOther;
  else if (!answers)
    finding.verdict = Verdict::kWeak;
  else if (std::abs(finding.share) > kStrongest)
    finding.verdict = Verdict::kStrong;
  else
    finding.verdict = finding.share < 0 ? Verdict::kReversed : Verdict::kRight;
  ++motor_;
  force_N_ = kFirst_N;
}

HandWay handWay(const Vec3& way_D) noexcept {
  HandWay way{.length_m = way_D.norm()};
  way_D.cwiseAbs().maxCoeff(&way.axis);
  way.positive = way_D[way.axis] > 0;
  return way;
}

bool isAsked(const HandWay& way, int axis) noexcept {
  constexpr double kShortest = 0.6, kLongest = 1.6;  // of what was asked
  return way.axis == axis && way.positive && way.length_m >= kShortest * kAsked_m &&
         way.length_m <= kLongest * kAsked_m;
}

std::optional<Vec3> HandMove::look(const Vec3& position_D, double time_s) noexcept {
  if (!((position_D - rest_D_).norm() <= kRest_m)) {
    rest_D_ = position_D;
    rests_s_ = time_s;
  }
  if (time_s - rests_s_ < kRest_s) return {};
  if (!from_D_) from_D_ = position_D;
  const Vec3 way_D = position_D - *from_D_;
  if (way_D.norm() < kLeast_m) return {};
  return way_D;
}

const char* wordOf(const HandWay& way) noexcept {
  constexpr std::array<std::array<const char*, 2>, 3> kWords = {
      {{"left", "right"}, {"down", "up"}, {"away from you", "towards you"}}};
  return kWords[static_cast<std::size_t>(way.axis)][way.positive ? 1 : 0];
}

}  // namespace palpate
