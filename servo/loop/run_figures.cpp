// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_figures.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "base/vec.hpp"
#include "servo/safety/passivity.hpp"

namespace palpate {
namespace {

constexpr double kMicrosecondsPerNanosecond = 1e-3;
constexpr double kMillisecondsPerNanosecond = 1e-6;

template <typename Value>
Percentiles over(std::span<const TickRecord> records, bool contact_only, Value value) {
  std::vector<double> values;
  values.reserve(records.size());
  for (const TickRecord& record : records) {
    if (contact_only && !record.in_contact) continue;
    if (const double v = value(record); !std::isnan(v)) values.push_back(v);
  }
  return percentiles(std::move(values));
}

void addEffects(std::span<const TickRecord> records, RunFigures& figures) {
  for (const TickRecord& record : records) figures.effect_runs += record.effects;
}

void addContact(std::span<const TickRecord> records, RunFigures& figures) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TickRecord& now = records[i];
    const TickRecord* before = i > 0 ? &records[i - 1] : nullptr;
    if (before) {
      const double step_N = (asVec3(now.force_W) - asVec3(before->force_W)).norm();
      figures.force_step_max_N = std::max(figures.force_step_max_N, step_N);
    }
    if (!now.in_contact) continue;
    ++figures.contact_ticks;
    if (figures.first_contact_s < 0) figures.first_contact_s = now.time_s;
    if (before && before->in_contact) {
      figures.surface_way_m += (surfacePointOf(now) - surfacePointOf(*before)).norm();
    } else {
      ++figures.touches;
    }
  }
}

void addLoop(std::span<const TickRecord> records, RunFigures& figures) {
  std::vector<std::uint64_t> versions;
  for (const TickRecord& record : records) {
    figures.plane_age_max_ticks = std::max(figures.plane_age_max_ticks, record.plane_age_ticks);
    if (record.faults != 0) ++figures.faulty_ticks;
    if (has(record.faults, ServoFault::kOverrun)) ++figures.late_ticks;
    if (versions.empty() || versions.back() != record.window_version) versions.push_back(record.window_version);
  }
  figures.windows_used = versions.size();
}

// Measured on the grid, not in ticks that were run: ticks that were left out took time too.
void addTimes(std::span<const TickRecord> records, double rate_hz, std::int64_t grid_points, RunFigures& figures) {
  if (records.empty()) return;
  const std::int64_t first = records.front().tick;
  const std::int64_t points = std::max(grid_points, records.back().tick + 1 - first);
  std::int64_t in_contact = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::int64_t next = i + 1 < records.size() ? records[i + 1].tick : first + points;
    if (records[i].in_contact) in_contact += next - records[i].tick;
  }
  figures.skipped_ticks = points - figures.ticks;
  figures.time_s = static_cast<double>(points) / rate_hz;
  figures.contact_s = static_cast<double>(in_contact) / rate_hz;
}

void addEnergy(std::span<const TickRecord> records, RunFigures& figures) {
  for (const TickRecord& record : records) {
    figures.energy_min_J = std::min(figures.energy_min_J, record.energy_J);
    if (record.in_contact && record.energy_J < -Passivity::kRounding_J) ++figures.active_ticks;
    if (record.damped) ++figures.damped_ticks;
  }
  if (!records.empty()) figures.energy_end_J = records.back().energy_J;
}

void addFaults(std::span<const TickRecord> records, RunFigures& figures) {
  std::vector<FaultCount> counts;
  for (const FaultText& row : faultTable()) counts.push_back({row.fault, 0, 0});
  for (const TickRecord& record : records) {
    if (record.faults == 0) continue;  // the usual case
    for (FaultCount& count : counts) {
      if (!has(record.faults, count.fault)) continue;
      if (count.ticks++ == 0) count.first_tick = record.tick;
    }
  }
  std::erase_if(counts, [](const FaultCount& count) { return count.ticks == 0; });
  figures.faults = std::move(counts);
}

}  // namespace

double forceOf(const TickRecord& record) noexcept {
  return asVec3(record.force_W).norm();
}

double depthOf(const TickRecord& record) noexcept {
  return record.in_contact ? record.depth_m : 0;
}

Vec3 surfacePointOf(const TickRecord& record) noexcept {
  if (!record.in_contact || std::isnan(record.depth_m)) return asVec3(record.vhip_W);
  return asVec3(record.hip_W) + record.depth_m * asVec3(record.normal_W);
}

RunFigures computeFigures(std::span<const TickRecord> records, double rate_hz, std::int64_t grid_points) {
  RunFigures figures;
  figures.ticks = static_cast<std::int64_t>(records.size());
  addTimes(records, rate_hz, grid_points, figures);
  addContact(records, figures);
  addEffects(records, figures);
  addLoop(records, figures);
  addEnergy(records, figures);
  addFaults(records, figures);
  figures.force_N = over(records, true, forceOf);
  figures.depth_m = over(records, true, depthOf);
  figures.tick_cost_us =
      over(records, false, [](const TickRecord& r) { return r.tick_cost_ns * kMicrosecondsPerNanosecond; });
  figures.lateness_us = over(records, false, [](const TickRecord& r) {
    return static_cast<double>(r.lateness_ns) * kMicrosecondsPerNanosecond;
  });
  figures.window_age_ms = over(records, false, [](const TickRecord& r) {
    return static_cast<double>(r.window_age_ns) * kMillisecondsPerNanosecond;
  });
  return figures;
}

}  // namespace palpate
