// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/fault_counts.hpp: in how many ticks each fault was raised. One thread; no cost.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "servo/loop/tick_record.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

class FaultCounts {
 public:
  void add(const TickRecord& tick) noexcept {
    for (std::uint32_t left = tick.faults; left != 0; left &= left - 1) ++ticks_[lowest(left)];
  }
  [[nodiscard]] std::uint64_t ticks(ServoFault fault) const noexcept { return ticks_[lowest(bit(fault))]; }

 private:
  static std::size_t lowest(std::uint32_t bits) noexcept { return static_cast<std::size_t>(std::countr_zero(bits)); }
  std::array<std::uint64_t, 33> ticks_{};  // by the bit's number; the last is that of no bit
};

}  // namespace palpate
