// SPDX-License-Identifier: Apache-2.0
// servo/loop/loop_statistics.hpp: the figures of a run, from its records alone.
//
// Percentiles are by nearest rank: the smallest value that at least that share of the ticks does not exceed. Penetration is
// |VHIP - HIP| in ticks in contact; force is what was sent; a jump is the change of the sent force between records that follow
// each other. A missed deadline is a record with kOverrun.
// Thread: after the run. Cost: sorts three columns. Errors: none; no records give zeros.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "servo/loop/tick_record.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

struct Percentiles {
  std::int64_t p50 = 0, p90 = 0, p99 = 0, p99_9 = 0, max = 0;
};

// Of any values; they need not be sorted.
[[nodiscard]] Percentiles percentilesOf(std::vector<std::int64_t> values);

struct FaultCount {
  ServoFault fault = ServoFault::kNone;
  std::int64_t ticks = 0;       // with this bit
  std::int64_t first_tick = 0;
};

struct LoopStatistics {
  std::int64_t ticks = 0;
  Percentiles tick_cost_ns, lateness_ns, window_age_ns;
  std::int64_t deadline_misses = 0;
  std::int64_t skipped_ticks = 0;  // gaps in the tick numbers

  std::int64_t contact_ticks = 0;
  std::int64_t contacts = 0;           // times that contact began
  double mean_force_N = 0, max_force_N = 0;              // mean over ticks in contact, maximum over all
  double mean_penetration_m = 0, max_penetration_m = 0;  // over ticks in contact
  double max_force_jump_N = 0;         // in one tick

  std::vector<FaultCount> faults;      // those that occurred, lowest bit first
};

[[nodiscard]] LoopStatistics statisticsOf(std::span<const TickRecord> records);

}  // namespace palpate
