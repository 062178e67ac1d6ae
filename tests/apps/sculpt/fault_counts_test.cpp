// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/fault_counts.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace fault_counts_test {

TEST(FaultCounts, CountsTheTicksOfEach) {
  FaultCounts counts;
  TickRecord tick;
  counts.add(tick);
  tick.faults = bit(ServoFault::kNoWindow) | bit(ServoFault::kPlaneBehind);
  counts.add(tick);
  counts.add(tick);
  tick.faults = bit(ServoFault::kPlaneBehind);
  counts.add(tick);
  for (const FaultText& fault : faultTable()) {
    const std::uint64_t ticks = fault.fault == ServoFault::kNoWindow      ? 2
                                : fault.fault == ServoFault::kPlaneBehind ? 3
                                                                          : 0;
    EXPECT_EQ(counts.ticks(fault.fault), ticks) << fault.name;
  }
}

}  // namespace fault_counts_test
}  // namespace palpate
