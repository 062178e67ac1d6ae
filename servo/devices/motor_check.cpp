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

void MotorCheck::Model::pass(double time_s, double mass_kg, double damping_Ns_per_m) noexcept {
  constexpr double kStep_s = 1e-3;
  const int steps = std::max(1, static_cast<int>(std::ceil(time_s / kStep_s)));
  const double step_s = time_s / steps;
  for (int i = 0; i < steps; ++i) {
    speed_m_per_s += step_s * (force_N - damping_Ns_per_m * speed_m_per_s) / mass_kg;
    way_m += step_s * speed_m_per_s;
  }
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
  last_s_ = time_s;
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
    most_noise_m_ = std::max(most_noise_m_, noise_m_);
    model_ = {};
    sums_ = {};
  } else if (time_s - begin_s_ >= kPatience_s) {
    motor_ = 3;  // whoever does not hold it still for one motor does not for the next
  }
}

void MotorCheck::push(double time_s) noexcept {
  const double passed_s = time_s - begin_s_;
  if (phase_ == Phase::kPush && passed_s < kPush_s) {
    model_.pass(time_s - last_s_, arm_.mass_kg(), arm_.damping_Ns_per_m());
    sums_.way += arm_.angles() - start_;
    sums_.expected_m += sign_ * model_.way_m;
    ++sums_.samples;
    return pushBy(sign_ * force_N_ * halfSine(passed_s));
  }
  phase_ = Phase::kBrake;
  if (passed_s < 2 * kPush_s) return pushBy(-sign_ * force_N_ * halfSine(passed_s - kPush_s));
  arm_.push(motor_, 0);
  phase_ = Phase::kBegin;
  endPush();
}

void MotorCheck::pushBy(double force_N) noexcept {
  model_.force_N = arm_.push(motor_, force_N);
  constexpr double kRounding = 1e-9;
  is_cut_ = is_cut_ || std::abs(model_.force_N) < (1 - kRounding) * std::abs(force_N);
}

// Of the two signs half the difference: what they have in common is the hand's drift.
void MotorCheck::endPush() noexcept {
  const double samples = std::max(1, sums_.samples);
  answer_ += sign_ / 2 * sums_.way / samples;
  expected_m_ += sums_.expected_m / samples / 2;
  sign_ = -sign_;
  if (sign_ > 0) judge();
}

void MotorCheck::beginForce(double force_N) noexcept {
  force_N_ = force_N;
  answer_.setZero();
  expected_m_ = most_noise_m_ = 0;
  tries_ = 0;
  is_cut_ = false;
}

void MotorCheck::judge() noexcept {
  using Verdict = MotorFinding::Verdict;
  MotorFinding& finding = findings_[static_cast<std::size_t>(motor_)];
  ++tries_;
  const double less_noise = 1 / std::sqrt(tries_);
  const Vec3 mean = answer_ / tries_;
  const Vec3 ways_m = mean.cwiseProduct(levers_m_);
  ways_m.cwiseAbs().maxCoeff(&finding.joint);
  const bool is_clear = std::abs(mean[finding.joint]) >= std::max(kClear_counts * less_noise, kLeastClear_counts) *
                                                             std::abs(arm_.counts_rad()[finding.joint]) &&
                        std::abs(ways_m[finding.joint]) >= kClear * most_noise_m_ * less_noise;
  const double expected_m = expected_m_ / tries_;
  finding.share = expected_m > 0 ? ways_m[finding.joint] / expected_m : 0;
  const bool answers = is_clear && std::abs(finding.share) >= kWeakest;
  if (!answers && is_cut_ && tries_ < kMostTries) return;
  if (!answers && !is_cut_ && force_N_ < kLast_N) return beginForce(std::min(2 * force_N_, kLast_N));
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
  beginForce(kFirst_N);
}

}  // namespace palpate
