// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/loop_statistics.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace palpate {
namespace {

TEST(LoopStatistics, PercentilesByNearestRank) {
  std::vector<std::int64_t> values(1000);
  std::iota(values.rbegin(), values.rend(), 1);  // 1000 ... 1
  const Percentiles p = percentilesOf(values);
  EXPECT_EQ(p.p50, 500);
  EXPECT_EQ(p.p90, 900);
  EXPECT_EQ(p.p99, 990);
  EXPECT_EQ(p.p99_9, 999);
  EXPECT_EQ(p.max, 1000);
  const Percentiles of_three = percentilesOf({7, 5, 9});
  EXPECT_EQ(of_three.p50, 7);
  EXPECT_EQ(of_three.p90, 9);
  EXPECT_EQ(percentilesOf({}).max, 0);
}

TickRecord record(std::int64_t tick, bool contact, double force_N, double depth_m, std::uint32_t faults = 0) {
  TickRecord r;
  r.tick = tick;
  r.in_contact = contact;
  r.force_W[2] = force_N;
  r.vhip_W[2] = depth_m;
  r.faults = faults;
  r.tick_cost_ns = static_cast<std::int32_t>(100 * tick);
  r.lateness_ns = 10 * tick;
  r.window_age_ns = tick;
  return r;
}

TEST(LoopStatistics, CountsContactsForcesAndFaults) {
  const std::uint32_t overrun = bit(ServoFault::kOverrun);
  const std::uint32_t beyond = bit(ServoFault::kBeyondWindow);
  const std::vector<TickRecord> records = {record(0, false, 0, 0),          record(1, true, 1, 0.002),
                                           record(2, true, 3, 0.006, overrun), record(5, false, 0.5, 0, beyond),
                                           record(6, true, -4, 0.004, beyond)};
  const LoopStatistics s = statisticsOf(records);
  EXPECT_EQ(s.ticks, 5);
  EXPECT_EQ(s.skipped_ticks, 2);
  EXPECT_EQ(s.deadline_misses, 1);
  EXPECT_EQ(s.contact_ticks, 3);
  EXPECT_EQ(s.contacts, 2);
  EXPECT_DOUBLE_EQ(s.mean_force_N, (1 + 3 + 4) / 3.0);
  EXPECT_DOUBLE_EQ(s.max_force_N, 4);
  EXPECT_DOUBLE_EQ(s.mean_penetration_m, 0.004);
  EXPECT_DOUBLE_EQ(s.max_penetration_m, 0.006);
  EXPECT_DOUBLE_EQ(s.max_force_jump_N, 4.5);
  EXPECT_EQ(s.tick_cost_ns.p50, 200);
  EXPECT_EQ(s.lateness_ns.max, 60);
  EXPECT_EQ(s.window_age_ns.p90, 6);
  ASSERT_EQ(s.faults.size(), 2u);
  EXPECT_EQ(s.faults[0].fault, ServoFault::kBeyondWindow);
  EXPECT_EQ(s.faults[0].ticks, 2);
  EXPECT_EQ(s.faults[0].first_tick, 5);
  EXPECT_EQ(s.faults[1].fault, ServoFault::kOverrun);
}

TEST(LoopStatistics, NoRecords) {
  const LoopStatistics s = statisticsOf({});
  EXPECT_EQ(s.ticks, 0);
  EXPECT_EQ(s.mean_force_N, 0);
}

}  // namespace
}  // namespace palpate
