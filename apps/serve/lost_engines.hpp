// SPDX-License-Identifier: Apache-2.0
// apps/serve/lost_engines.hpp: how often an engine may be lost and made anew before the service gives up. Any thread.
#pragma once

#include <cstdint>
#include <deque>

namespace palpate {

class LostEngines {
 public:
  static constexpr std::size_t kMost = 20;  // within kWithin_ns
  static constexpr std::int64_t kWithin_ns = 60'000'000'000;

  // One more was lost. False: too many in too short a time. `now_ns`: of a clock that does not go back [ns].
  [[nodiscard]] bool mayGoOn(std::int64_t now_ns) {
    while (!at_ns_.empty() && now_ns - at_ns_.front() > kWithin_ns) at_ns_.pop_front();
    at_ns_.push_back(now_ns);
    return at_ns_.size() <= kMost;
  }

 private:
  std::deque<std::int64_t> at_ns_;
};

}  // namespace palpate
