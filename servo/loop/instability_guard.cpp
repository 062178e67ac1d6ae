// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/instability_guard.hpp"

#include <cmath>

#include "base/error.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

InstabilityGuard::InstabilityGuard(const InstabilityParameters& p, const DeviceLimits& device, double rate_hz)
    : parameters_(p),
      watch_(device.position_resolution_m),
      touches_(device.position_resolution_m, device.force_delay_ticks),
      away_ticks_(std::llround(p.away_s * rate_hz)) {
  checkSetting(p.away_s >= 0 && p.away_s <= 60, "time away after an unstable contact", p.away_s, "give 0 to 60 s");
  checkSetting(p.softer > 0 && p.softer < 1, "share of the force after an unstable contact", p.softer,
               "give a share between 0 and 1");
  parameters_.act = p.act && device.follows_force;
}

void InstabilityGuard::add(const TickRecord& record) noexcept {
  if (!parameters_.act) return;
  const bool swings = watch_.add(record);
  const bool bounces = parameters_.doubtful && touches_.add(record);
  if (unstable_) {
    away_since_ = record.in_contact ? 0 : away_since_ + 1;
    if (away_since_ > away_ticks_) unstable_ = false;
  } else if (swings || bounces) {
    unstable_ = true;
    away_since_ = 0;
    touches_.forget();
    share_ *= parameters_.softer;
  }
}

std::uint32_t InstabilityGuard::faults() const noexcept {
  return unstable_ ? bit(ServoFault::kUnstable) : 0;
}

void InstabilityGuard::takeNew(bool doubtful) noexcept {
  parameters_.doubtful = doubtful;
  touches_.forget();
  share_ = 1;
}

}  // namespace palpate
