// SPDX-License-Identifier: Apache-2.0
// servo/loop/tick_record.hpp: what the servo records of one tick: a row of trace.csv and the source of every statistic.
#pragma once

#include <cstdint>
#include <type_traits>

#include "base/vec.hpp"

namespace palpate {

struct TickRecord {
  std::int64_t tick = 0;    // counts from 0
  double time_s = 0;        // since the loop started: tick / rate [s]
  double hip_W[3] = {};     // device position as the servo read it [m]
  double vhip_W[3] = {};    // virtual haptic interface point [m]
  double normal_W[3] = {};  // of the plane in contact; zero without contact [-]
  double force_W[3] = {};   // held by the device from this tick on: the gate's, or the old one if refused [N]
  float density = 0;        // at the HIP; NaN beyond the window [density]
  std::int32_t plane_age_ticks = 0;
  std::uint64_t window_version = 0;
  std::uint32_t faults = 0;        // bits of ServoFault
  std::int32_t tick_cost_ns = 0;   // compute time of the tick, without sleep; 0 with the simulated clock [ns]
  std::int64_t lateness_ns = 0;    // wake-up after the due time; 0 with the simulated clock [ns]
  std::int64_t window_age_ns = 0;  // since the window in use was published [ns]
  double depth_m = 0;              // of the HIP below the surface, as TickOutput says [m]
  double energy_J = 0;             // taken from the hand by the environment so far (servo/safety/passivity.hpp) [J]
  std::uint64_t edit_version = 0;  // the volume edit that the window in use held
  bool in_contact = false;
  bool damped = false;       // the passivity controller added a force
  std::int32_t effects = 0;  // contact effects that ran
};
static_assert(std::is_trivially_copyable_v<TickRecord>);

[[nodiscard]] inline Vec3 asVec3(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}

}  // namespace palpate
