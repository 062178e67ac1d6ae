// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/loop_statistics.hpp"

#include <algorithm>
#include <cmath>

#include "base/vec.hpp"

namespace palpate {
namespace {

Vec3 vec(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

template <class Column>
Percentiles percentilesOfColumn(std::span<const TickRecord> records, Column TickRecord::* column) {
  std::vector<std::int64_t> values;
  values.reserve(records.size());
  for (const TickRecord& record : records) values.push_back(record.*column);
  return percentilesOf(std::move(values));
}

void addContact(std::span<const TickRecord> records, LoopStatistics& statistics) {
  double force_sum_N = 0;
  double depth_sum_m = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TickRecord& record = records[i];
    const Vec3 force_W = vec(record.force_W);
    statistics.max_force_N = std::max(statistics.max_force_N, force_W.norm());
    if (i > 0) {
      const double jump_N = (force_W - vec(records[i - 1].force_W)).norm();
      statistics.max_force_jump_N = std::max(statistics.max_force_jump_N, jump_N);
    }
    if (!record.in_contact) continue;
    const double depth_m = (vec(record.vhip_W) - vec(record.hip_W)).norm();
    ++statistics.contact_ticks;
    if (i == 0 || !records[i - 1].in_contact) ++statistics.contacts;
    force_sum_N += force_W.norm();
    depth_sum_m += depth_m;
    statistics.max_penetration_m = std::max(statistics.max_penetration_m, depth_m);
  }
  if (statistics.contact_ticks == 0) return;
  statistics.mean_force_N = force_sum_N / static_cast<double>(statistics.contact_ticks);
  statistics.mean_penetration_m = depth_sum_m / static_cast<double>(statistics.contact_ticks);
}

void addFaults(std::span<const TickRecord> records, LoopStatistics& statistics) {
  for (const FaultText& row : faultTable()) {
    FaultCount count{row.fault, 0, 0};
    for (const TickRecord& record : records) {
      if (!has(record.faults, row.fault)) continue;
      if (count.ticks++ == 0) count.first_tick = record.tick;
    }
    if (count.ticks > 0) statistics.faults.push_back(count);
    if (row.fault == ServoFault::kOverrun) statistics.deadline_misses = count.ticks;
  }
}

}  // namespace

Percentiles percentilesOf(std::vector<std::int64_t> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  // In tenths of a per cent, so that the rank is exact.
  const auto rank = [&](std::size_t per_mille) { return values[(values.size() * per_mille + 999) / 1000 - 1]; };
  return {rank(500), rank(900), rank(990), rank(999), values.back()};
}

LoopStatistics statisticsOf(std::span<const TickRecord> records) {
  LoopStatistics statistics;
  statistics.ticks = static_cast<std::int64_t>(records.size());
  statistics.tick_cost_ns = percentilesOfColumn(records, &TickRecord::tick_cost_ns);
  statistics.lateness_ns = percentilesOfColumn(records, &TickRecord::lateness_ns);
  statistics.window_age_ns = percentilesOfColumn(records, &TickRecord::window_age_ns);
  for (std::size_t i = 1; i < records.size(); ++i) statistics.skipped_ticks += records[i].tick - records[i - 1].tick - 1;
  addContact(records, statistics);
  addFaults(records, statistics);
  return statistics;
}

}  // namespace palpate
