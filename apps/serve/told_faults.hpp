// SPDX-License-Identifier: Apache-2.0
// apps/serve/told_faults.hpp: which faults of a servo its user is told while a service runs, and how often.
//
// Those for which the force goes though nothing else is told: an unstable contact, a force that is no number, a device
// that refuses or takes the force away, a servo that stood still. The others come and go with windows, edits and fast
// hands, and are counted (`palpate top`). One thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace palpate {

class ToldFaults {
 public:
  static constexpr std::int64_t kPause_ns = 10'000'000'000;  // until the same fault is told again [ns]
  using Tell = std::function<void(const std::string&)>;

  // At every pose, with its faults: tells those that begin.
  void look(std::uint32_t faults, std::int64_t now_ns, const Tell& tell);

 private:
  std::uint32_t before_ = 0;
  std::array<std::int64_t, 32> told_ns_ = {};  // by bit; 0: never
};

}  // namespace palpate
