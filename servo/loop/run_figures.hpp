// SPDX-License-Identifier: Apache-2.0
// servo/loop/run_figures.hpp: the figures of a run, from its records: contact, force, depth, energy, timing.
//
// Any thread. Cost: some passes and sorts over the records.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/quantile.hpp"
#include "base/vec.hpp"
#include "servo/loop/tick_record.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

struct FaultCount {
  ServoFault fault = ServoFault::kNone;
  std::int64_t ticks = 0;  // with this bit
  std::int64_t first_tick = 0;
};

struct RunFigures {
  std::int64_t ticks = 0;
  double time_s = 0;  // of the run: its grid points (ticks run and left out) over the rate [s]
  std::int64_t contact_ticks = 0;
  double contact_s = 0;         // a tick in contact lasts until the next one that was run [s]
  int touches = 0;              // how often contact began
  double first_contact_s = -1;  // when it first began [s]; -1: never
  Percentiles force_N;          // magnitude, over ticks in contact [N]
  Percentiles depth_m;          // of the HIP below the surface, over ticks in contact with a known depth [m]
  double force_step_max_N = 0;  // largest change of the force from one tick to the next [N]
  double surface_way_m = 0;     // length of the path of the surface point while in contact [m]
  Percentiles tick_cost_us;     // [us]
  Percentiles lateness_us;      // wake-up after the due time [us]
  Percentiles window_age_ms;    // [ms]
  std::int32_t plane_age_max_ticks = 0;
  std::int64_t late_ticks = 0;     // not done when the next tick was due (kOverrun)
  std::int64_t skipped_ticks = 0;  // grid points left out after late ticks
  std::int64_t faulty_ticks = 0;   // with any fault flag
  std::uint64_t windows_used = 0;  // different window versions
  double energy_min_J = 0;         // lowest value of energy_end_J over the run, at most 0 [J]
  double energy_end_J = 0;         // energy that the environment has taken from the hand by the end of the run [J]
  std::int64_t active_ticks = 0;   // ticks in contact with the energy below zero
  std::int64_t damped_ticks = 0;   // ticks in which the passivity controller added a force
  std::int64_t effect_runs = 0;    // contact effects that ran, summed over ticks
  std::vector<FaultCount> faults;  // those that occurred, lowest bit first
};

// `rate_hz`: of the servo [1/s]. `grid_points`: how many ticks were run or left out. 0: taken from the records' tick
// numbers, which do not count ticks left out after the last record. Without records all figures are 0.
[[nodiscard]] RunFigures computeFigures(std::span<const TickRecord> records, double rate_hz,
                                        std::int64_t grid_points = 0);

// Magnitude of the force [N] and depth [m] of one tick; depth is 0 without contact, NaN for an algorithm without a
// surface.
[[nodiscard]] double forceOf(const TickRecord& record) noexcept;
[[nodiscard]] double depthOf(const TickRecord& record) noexcept;

// The surface point over the HIP, along the normal: the VHIP before effects move it [m]. Without contact or without a
// surface it is the VHIP.
[[nodiscard]] Vec3 surfacePointOf(const TickRecord& record) noexcept;

}  // namespace palpate
