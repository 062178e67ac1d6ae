// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/giving_touches.hpp"

#include <algorithm>

#include "servo/loop/swing_watch.hpp"
#include "servo/safety/passivity.hpp"

namespace palpate {

bool GivingTouches::add(const TickRecord& record) noexcept {
  const bool was_open = meter_.open();
  const bool ended = meter_.add(record);
  if (!was_open && meter_.open() && record.time_s - end_s_ > kLongestFlight_s) forget();
  if (!ended) return false;
  end_s_ = record.time_s;
  if (meter_.contact().edited) {
    forget();
    return false;
  }
  touches_[next_] = meter_.contact();
  next_ = (next_ + 1) % kMostTouches;
  count_ = std::min(count_ + 1, kMostTouches);
  return fed();
}

bool GivingTouches::fed() const noexcept {
  const auto touch = [&](std::size_t back) -> const ContactEnergy& {
    return touches_[(next_ + kMostTouches - back) % kMostTouches];
  };
  double gift_J = -Passivity::kRounding_J, stored_J = 0, newer_J = 0;
  for (std::size_t back = 1; back <= count_; ++back) {
    gift_J += touch(back).net_J;
    stored_J += touch(back).stored_J;
    if (back % 2 == 0) newer_J += touch(back / 2).stored_J;
    const bool sustained = newer_J >= SwingWatch::kSustained * (stored_J - newer_J);
    if (back >= kTouches && back % 2 == 0 && sustained && gift_J > kGiftShare * stored_J) return true;
  }
  return false;
}

}  // namespace palpate
