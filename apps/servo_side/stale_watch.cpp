// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/stale_watch.hpp"

#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"

namespace palpate {

std::string StaleWatch::look(bool is_stale, std::int64_t now_ns) {
  if (is_stale) {
    if (!since_ns_) since_ns_ = now_ns;
    const bool may_be_told = !told_ns_ || now_ns - *told_ns_ >= kPause_ns;
    if (is_told_ || now_ns - *since_ns_ < kLasting_ns || !may_be_told) return {};
    is_told_ = true;
    told_ns_ = now_ns;
    return "the engine is there and sends no windows: it is busy, stopped, hangs, or makes itself anew; the force "
           "fades "
           "until they come (palpate faults)";
  }
  const double lasted_s = static_cast<double>(now_ns - since_ns_.value_or(now_ns)) / kNanosecondsPerSecond;
  since_ns_.reset();
  if (!std::exchange(is_told_, false)) return {};
  return fmt::format("the engine sends windows again; they were stale for {:.1f} s", lasted_s);
}

void StaleWatch::beginAnew() noexcept {
  if (!is_told_) since_ns_.reset();
}

}  // namespace palpate
