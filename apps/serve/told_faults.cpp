// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/told_faults.hpp"

#include <fmt/format.h>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr std::uint32_t kToldFaults = bit(ServoFault::kNonFiniteForce) | bit(ServoFault::kDeviceError) |
                                      bit(ServoFault::kStall) | bit(ServoFault::kUnstable) |
                                      bit(ServoFault::kForceOff) | bit(ServoFault::kCalibrationRefused);

}  // namespace

void ToldFaults::look(std::uint32_t faults, std::int64_t now_ns, const Tell& tell) {
  const std::uint32_t begun = faults & ~before_ & kToldFaults;
  before_ = faults;
  if (begun == 0) return;
  const auto table = faultTable();
  for (std::size_t i = 0; i < table.size(); ++i) {
    if ((begun >> i & 1U) == 0 || (told_ns_[i] != 0 && now_ns - told_ns_[i] < kPause_ns)) continue;
    told_ns_[i] = now_ns;
    tell(fmt::format("the servo: {}: {}; {} (palpate faults)", table[i].name, table[i].text, table[i].remedy));
  }
}

}  // namespace palpate
