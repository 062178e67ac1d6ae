// SPDX-License-Identifier: Apache-2.0
// servo/loop/run_figures.hpp: what the records of a run say in a few figures: contact, force, depth, energy, quality of
// the servo.
//
// Any thread. Cost: some passes and sorts over the records.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.hpp"
#include "servo/loop/quantile.hpp"
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
  double time_s = 0;  // of the run: ticks and those left out, over the rate [s]
  std::int64_t contact_ticks = 0;
  double contact_s = 0;         // a tick in contact lasts until the next one that was run [s]
  int touches = 0;              // how often contact began
  double first_contact_s = -1;  // when it first began [s]; -1: never
  Percentiles force_N;          // magnitude, over ticks in contact [N]
  Percentiles depth_m;          // of the HIP below the surface, over ticks in contact that know one [m]
  double force_step_max_N = 0;  // largest change of the force from one tick to the next [N]
  double surface_way_m = 0;     // length of the surface point's way while in contact [m]
  Percentiles tick_cost_us;     // [us]
  Percentiles lateness_us;      // wake-up after the due time [us]
  Percentiles window_age_ms;    // [ms]
  std::int32_t plane_age_max_ticks = 0;
  std::int64_t late_ticks = 0;     // not done when the next tick was due (kOverrun)
  std::int64_t skipped_ticks = 0;  // grid points left out after late ticks
  std::int64_t faulty_ticks = 0;   // with any fault flag
  std::uint64_t windows_used = 0;  // different window versions
  double energy_min_J = 0;         // least energy that the environment had taken from the hand, 0 before the run [J]
  double energy_end_J = 0;         // at the end: what it has taken in all [J]
  std::int64_t active_ticks = 0;   // in contact, in which it had given more than it took
  std::int64_t damped_ticks = 0;   // in which the passivity controller added a force
  std::vector<FaultCount> faults;  // those that occurred, lowest bit first
};

// `rate_hz` of the servo [1/s]. `grid_points`: how many ticks were run or left out; 0: as far as the records' numbers
// go, which says nothing of points left out behind the last. No records give all zeros.
[[nodiscard]] RunFigures computeFigures(std::span<const TickRecord> records, double rate_hz,
                                        std::int64_t grid_points = 0);

// Magnitude of the force [N] and depth [m] of one tick; depth is 0 without contact, NaN for an algorithm without a
// surface.
[[nodiscard]] double forceOf(const TickRecord& record) noexcept;
[[nodiscard]] double depthOf(const TickRecord& record) noexcept;

// The surface over the HIP, along its normal: where the VHIP is unless an effect moves it. The VHIP where there is no
// contact or no surface [m].
[[nodiscard]] Vec3 surfacePointOf(const TickRecord& record) noexcept;

}  // namespace palpate
