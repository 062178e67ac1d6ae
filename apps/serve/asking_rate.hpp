// SPDX-License-Identifier: Apache-2.0
// apps/serve/asking_rate.hpp: how often something may happen: a number of times at once, and then so many times a
// second. One thread.
#pragma once

#include <algorithm>
#include <cstdint>

#include "base/units.hpp"

namespace palpate {

class AskingRate {
 public:
  // `per_s`: in the long run [1/s]; `at_once`: without a pause.
  AskingRate(double per_s, double at_once) noexcept : per_s_(per_s), most_(at_once), left_(at_once) {}

  // Once more, at this time of a clock that does not go back [ns]. False: that is too often, and does not count.
  [[nodiscard]] bool mayAsk(std::int64_t now_ns) noexcept {
    if (last_ns_ != 0) left_ += per_s_ * static_cast<double>(now_ns - last_ns_) / kNanosecondsPerSecond;
    last_ns_ = now_ns;
    left_ = std::min(left_, most_);
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  double per_s_, most_, left_;
  std::int64_t last_ns_ = 0;
};

}  // namespace palpate
