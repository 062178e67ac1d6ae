// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety_gate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

std::int64_t nanoseconds(double time_s) {
  return std::llround(time_s * kNanosecondsPerSecond);
}

// The fade time from `force_N` in ticks, rounded down: the force is zero within the time, not after it. The tolerance
// is for products such as 0.1 s * 1 kHz. If the slew limit needs more ticks, there is one to spare, so that rounding
// never makes a step of the fade exceed the slew.
std::int64_t fadeTicksOf(const SafetyParameters& p, double force_N, double rate_hz) {
  constexpr double kMostTicks = 1e15;
  const double by_time = std::floor(p.fade_s * rate_hz + 1e-6);
  const double by_slew = std::floor(std::min(force_N / p.slew_limit_N_per_s * rate_hz, kMostTicks)) + 1;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::max(by_time, by_slew)));
}

}  // namespace

SafetyGate::SafetyGate(const SafetyParameters& p, double rate_hz)
    : parameters_(p), rate_hz_(rate_hz), slew_per_tick_N_(p.slew_limit_N_per_s / rate_hz) {
  checkSetting(rate_hz > 0, "rate", rate_hz, "give a positive rate in Hz");
  checkSetting(p.force_limit_N > 0, "force limit", p.force_limit_N, "give newtons above 0");
  checkSetting(p.slew_limit_N_per_s > 0, "slew limit", p.slew_limit_N_per_s, "give newtons per second above 0");
  checkSetting(p.fade_s >= 0 && p.fade_s <= 60, "fade time", p.fade_s, "give 0 to 60 seconds");
  checkSetting(p.stale_window_s >= 0 && p.stale_window_s <= 1e6, "stale window time", p.stale_window_s,
               "give 0 to 1e6 seconds");
  checkSetting(p.stall_s >= 0 && p.stall_s <= 1e6, "stall time", p.stall_s, "give 0 to 1e6 seconds");
  checkSetting(p.report_timeout_s >= 0 && p.report_timeout_s <= 1e6, "report timeout", p.report_timeout_s,
               "give 0 to 1e6 seconds");
  checkSetting(p.start_s >= 0 && p.start_s <= 60, "start time", p.start_s, "give 0 to 60 seconds");
  fade_ticks_ = fadeTicksOf(p, p.force_limit_N, rate_hz);
  start_ticks_ = static_cast<std::int64_t>(std::ceil(p.start_s * rate_hz - 1e-6));
  stale_ns_ = nanoseconds(p.stale_window_s);
  stall_ns_ = nanoseconds(p.stall_s + 1 / rate_hz);
  report_timeout_ns_ = nanoseconds(p.report_timeout_s);
  authority_ticks_ = fade_ticks_;
}

// The authority stays the same share of the whole. A fade under way goes on from the force held. Otherwise it could
// grow again when a lower limit had cut it and a higher one followed.
void SafetyGate::setForceLimit(double force_limit_N) noexcept {
  parameters_.force_limit_N = force_limit_N;
  const std::int64_t before = std::exchange(fade_ticks_, fadeTicksOf(parameters_, force_limit_N, rate_hz_));
  if (authority_ticks_ == before) {
    authority_ticks_ = fade_ticks_;
  } else {
    const double scale = static_cast<double>(fade_ticks_) / static_cast<double>(before);
    authority_ticks_ = static_cast<std::int64_t>(std::floor(static_cast<double>(authority_ticks_) * scale));
  }
  fade_from_W_ = held_W_;
  fade_from_ticks_ = authority_ticks_;
}

std::uint32_t SafetyGate::faultsOf(const GateInput& in) const noexcept {
  std::uint32_t faults = in.faults;
  if (!in.wanted_W.allFinite()) faults |= bit(ServoFault::kNonFiniteForce);
  if (in.window_age_ns > stale_ns_) faults |= bit(ServoFault::kStaleWindow);
  if (in.gap_ns > stall_ns_) faults |= bit(ServoFault::kStall);
  if (in.report_age_ns > report_timeout_ns_) faults |= bit(ServoFault::kDroppedReports);
  return faults;
}

GateOutput SafetyGate::pass(const GateInput& in) noexcept {
  std::uint32_t faults = faultsOf(in);
  const bool fades = (faults & kFadingFaults) != 0 || lets_go_;
  // Of a device that exerts no force nothing is left to fade.
  if (has(faults, ServoFault::kStall) || has(faults, ServoFault::kForceOff)) authority_ticks_ = 0;
  if (fades && (!fading_ || releases_)) {
    fade_from_W_ = held_W_;
    fade_from_ticks_ = authority_ticks_;
  }
  fading_ = fades;
  releases_ = false;
  if (fades) {
    // kSlewLimited is not raised here. The slew limit is part of the fade; it holds the force back only after a stall
    // or refused writes.
    offerFaded();
    if (authority_ticks_ == 0) lets_go_ = false;
  } else if (!offerTowards(limited(in.wanted_W, faults))) {
    faults |= bit(ServoFault::kSlewLimited);
  }
  return {offer_W_, faults};
}

void SafetyGate::beginAnew() noexcept {
  started_ticks_ = 0;
  lets_go_ = true;
}

std::int64_t SafetyGate::releaseTicks() const noexcept {
  if (releases_) return authority_ticks_;
  return std::min(authority_ticks_, fadeTicksOf(parameters_, held_W_.stableNorm(), rate_hz_));
}

// From the force held, and not from the limit: a slew that is hardly any would else make the end of a run that held
// little take for ever.
Vec3 SafetyGate::release(std::int64_t gap_ns) noexcept {
  if (isStall(gap_ns)) authority_ticks_ = 0;
  if (!releases_) {
    authority_ticks_ = fade_from_ticks_ = releaseTicks();
    fade_from_W_ = held_W_;
    fading_ = releases_ = true;
  }
  offerFaded();
  return offer_W_;
}

void SafetyGate::taken(const Vec3& held_W) noexcept {
  const bool within = held_W.allFinite() && held_W.stableNorm() <= parameters_.force_limit_N;
  held_W_ = within ? held_W : offer_W_;
}

Vec3 SafetyGate::withinLimit(const Vec3& force_W) const noexcept {
  const double size_N = force_W.stableNorm();
  // Divided first: a huge force times the limit would overflow.
  return size_N > parameters_.force_limit_N ? Vec3(force_W / size_N * parameters_.force_limit_N) : force_W;
}

// A device that let its force go by itself does not get a part of it back.
void SafetyGate::offerFaded() noexcept {
  Vec3 left_W = Vec3::Zero();
  if (authority_ticks_ > 0 && --authority_ticks_ > 0)
    left_W =
        withinLimit(fade_from_W_ * (static_cast<double>(authority_ticks_) / static_cast<double>(fade_from_ticks_)));
  static_cast<void>(offerTowards(left_W.stableNorm() > held_W_.stableNorm() ? held_W_ : left_W));
}

Vec3 SafetyGate::limited(const Vec3& wanted_W, std::uint32_t& faults) noexcept {
  if (authority_ticks_ < fade_ticks_) ++authority_ticks_;
  Vec3 target_W = withinLimit(wanted_W);
  if (target_W != wanted_W) faults |= bit(ServoFault::kForceLimited);
  if (authority_ticks_ < fade_ticks_)
    target_W *= static_cast<double>(authority_ticks_) / static_cast<double>(fade_ticks_);
  if (started_ticks_ < start_ticks_)
    target_W *= static_cast<double>(++started_ticks_) / static_cast<double>(start_ticks_);
  return target_W;
}

// The force held and the target both lie in the ball of the force limit, so every point between them does.
bool SafetyGate::offerTowards(const Vec3& target_W) noexcept {
  const Vec3 change_W = target_W - held_W_;
  const double change_N = change_W.norm();
  const bool reached = change_N <= slew_per_tick_N_;
  offer_W_ = reached ? target_W : Vec3(held_W_ + change_W * (slew_per_tick_N_ / change_N));
  return reached;
}

}  // namespace palpate
