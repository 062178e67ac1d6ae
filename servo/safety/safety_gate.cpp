// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/safety_gate.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

void check(bool good, const char* key, double value, const char* remedy) {
  if (!good) throw Error(Error::Code::kBadInput, key, fmt::format("{:g} cannot be used", value), remedy);
}

}  // namespace

SafetyGate::SafetyGate(const SafetyParameters& p, double rate_hz)
    : force_limit_N_(p.force_limit_N), slew_per_tick_N_(p.slew_limit_N_per_s / rate_hz) {
  check(std::isfinite(rate_hz) && rate_hz > 0, "rate", rate_hz, "give a positive rate in Hz");
  check(std::isfinite(p.force_limit_N) && p.force_limit_N > 0, "force limit", p.force_limit_N, "give newtons above 0");
  check(std::isfinite(p.slew_limit_N_per_s) && p.slew_limit_N_per_s > 0, "slew limit", p.slew_limit_N_per_s,
        "give newtons per second above 0");
  check(p.fade_s >= 0 && p.fade_s <= 60, "fade time", p.fade_s, "give 0 to 60 seconds");
  check(p.stale_window_s >= 0 && p.stale_window_s <= 1e6, "stale window time", p.stale_window_s,
        "give 0 to 1e6 seconds");
  // Rounded down, so that the force is zero within the time, not after it; the tolerance is for 0.1 s * 1 kHz.
  fade_ticks_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::floor(p.fade_s * rate_hz + 1e-6)));
  stale_ns_ = std::llround(p.stale_window_s * kNanosecondsPerSecond);
  authority_ticks_ = fade_ticks_;
}

GateOutput SafetyGate::pass(const GateInput& in) noexcept {
  GateOutput out{Vec3::Zero(), in.faults};
  if (!in.wanted_W.allFinite()) out.faults |= bit(ServoFault::kNonFiniteForce);
  if (in.window_age_ns > stale_ns_) out.faults |= bit(ServoFault::kStaleWindow);
  const bool faulty = (out.faults & kFadingFaults) != 0;
  if (faulty && !fading_) {
    hold_W_ = last_W_;
    hold_ticks_ = authority_ticks_;
  }
  fading_ = faulty;
  last_W_ = faulty ? faded() : limited(in.wanted_W, out.faults);
  out.force_W = last_W_;
  return out;
}

Vec3 SafetyGate::faded() noexcept {
  if (authority_ticks_ > 0) --authority_ticks_;
  if (authority_ticks_ == 0) return Vec3::Zero();
  return hold_W_ * (static_cast<double>(authority_ticks_) / static_cast<double>(hold_ticks_));
}

// The last force and the target both lie in the ball of the force limit, so every point between them does.
Vec3 SafetyGate::limited(const Vec3& wanted_W, std::uint32_t& faults) noexcept {
  if (authority_ticks_ < fade_ticks_) ++authority_ticks_;
  Vec3 target_W = wanted_W;
  const double size_N = wanted_W.stableNorm();
  if (size_N > force_limit_N_) {
    // Divided first: a huge force times the limit would overflow.
    target_W = wanted_W / size_N * force_limit_N_;
    faults |= bit(ServoFault::kForceLimited);
  }
  if (authority_ticks_ < fade_ticks_)
    target_W *= static_cast<double>(authority_ticks_) / static_cast<double>(fade_ticks_);
  const Vec3 change_W = target_W - last_W_;
  const double change_N = change_W.norm();
  if (change_N <= slew_per_tick_N_) return target_W;
  faults |= bit(ServoFault::kSlewLimited);
  return last_W_ + change_W * (slew_per_tick_N_ / change_N);
}

}  // namespace palpate
