// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/run_figures.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "servo/safety/passivity.hpp"

namespace palpate {
namespace run_figures_test {

TickRecord record(std::int64_t tick, bool contact, double force_N, double depth_m, std::uint32_t faults = 0) {
  TickRecord r;
  r.tick = tick;
  r.time_s = static_cast<double>(tick) / 1000;
  r.in_contact = contact;
  r.force_W[2] = force_N;
  r.normal_W[2] = contact ? 1 : 0;
  r.hip_W[0] = static_cast<double>(tick) * 1e-3;  // a millimetre sideways a tick
  r.depth_m = contact ? depth_m : 0;
  r.vhip_W[2] = 3 * depth_m;  // an effect makes the contact three times as stiff
  r.faults = faults;
  r.tick_cost_ns = static_cast<std::int32_t>(100 * tick);
  r.lateness_ns = 10'000 * tick;
  r.window_age_ns = 1'000'000 * tick;
  r.window_version = tick < 5 ? 1 : 2;
  return r;
}

// Two touches by hand, ticks 3 and 4 left out.
std::vector<TickRecord> twoTouches() {
  const std::uint32_t overrun = bit(ServoFault::kOverrun);
  const std::uint32_t beyond = bit(ServoFault::kBeyondWindow);
  return {record(0, false, 0, 0), record(1, true, 1, 0.002), record(2, true, 3, 0.006, overrun),
          record(5, false, 0.5, 0, beyond), record(6, true, -4, 0.004, beyond)};
}

TEST(RunFigures, CountContactForceAndDepth) {
  const RunFigures f = computeFigures(twoTouches(), 1000);
  EXPECT_EQ(f.ticks, 5);
  EXPECT_EQ(f.contact_ticks, 3);
  EXPECT_EQ(f.touches, 2);
  EXPECT_DOUBLE_EQ(f.contact_s, 5e-3);  // tick 2 until tick 5
  EXPECT_DOUBLE_EQ(f.time_s, 7e-3);     // grid points 0 to 6
  EXPECT_DOUBLE_EQ(f.first_contact_s, 1e-3);
  EXPECT_DOUBLE_EQ(f.depth_m.p50, 0.004);
  EXPECT_DOUBLE_EQ(f.depth_m.max, 0.006);
  EXPECT_DOUBLE_EQ(f.force_N.p50, 3);
  EXPECT_DOUBLE_EQ(f.force_N.max, 4);
  EXPECT_DOUBLE_EQ(f.force_step_max_N, 4.5);  // from 0.5 to -4
  // Within the first touch only: 1 mm sideways and 4 mm down.
  EXPECT_DOUBLE_EQ(f.surface_way_m, std::hypot(1e-3, 4e-3));
}

TEST(RunFigures, CountLateSkippedAndFaultyTicks) {
  const RunFigures f = computeFigures(twoTouches(), 1000);
  EXPECT_EQ(f.late_ticks, 1);
  EXPECT_EQ(f.skipped_ticks, 2);
  EXPECT_EQ(f.faulty_ticks, 3);
  EXPECT_EQ(f.windows_used, 2U);
  EXPECT_DOUBLE_EQ(f.tick_cost_us.p50, 0.2);
  EXPECT_DOUBLE_EQ(f.lateness_us.max, 60);
  EXPECT_DOUBLE_EQ(f.window_age_ms.p90, 6);
  // Of every tick, in contact or not; what is felt, of those in contact.
  EXPECT_EQ(f.tick_cost_us.count, 5U);
  EXPECT_EQ(f.lateness_us.count, 5U);
  EXPECT_EQ(f.window_age_ms.count, 5U);
  EXPECT_EQ(f.force_N.count, 3U);
  EXPECT_EQ(f.depth_m.count, 3U);
  ASSERT_EQ(f.faults.size(), 2U);
  EXPECT_EQ(f.faults[0].fault, ServoFault::kBeyondWindow);
  EXPECT_EQ(f.faults[0].ticks, 2);
  EXPECT_EQ(f.faults[0].first_tick, 5);
  EXPECT_EQ(f.faults[1].fault, ServoFault::kOverrun);
}

// Points left out behind the last record are in no gap: the loop knows of them. A contact lasts through them.
TEST(RunFigures, TimesCoverWhatWasLeftOut) {
  const RunFigures f = computeFigures(twoTouches(), 1000, 10);
  EXPECT_EQ(f.ticks + f.skipped_ticks, 10);
  EXPECT_DOUBLE_EQ(f.time_s, 10e-3);
  EXPECT_DOUBLE_EQ(f.contact_s, 8e-3);
  std::vector<TickRecord> later = twoTouches();  // of a part of a run
  for (TickRecord& r : later) r.tick += 1000;
  EXPECT_DOUBLE_EQ(computeFigures(later, 1000).time_s, 7e-3);
  EXPECT_EQ(computeFigures(later, 1000).skipped_ticks, 2);
}

// In contact from the first tick to the last: contact begins at time 0 and once, each step is that from the tick
// before, the largest being the first.
TEST(RunFigures, OfAContactFromTheFirstTickOn) {
  std::vector<TickRecord> records = {record(0, true, 9, 0.001), record(1, true, 2, 0.005), record(2, true, 4, 0.006)};
  const int ages[] = {3, 7, 5};
  for (std::size_t i = 0; i < 3; ++i) records[i].plane_age_ticks = ages[i];
  const RunFigures f = computeFigures(records, 1000);
  EXPECT_EQ(f.first_contact_s, 0);
  EXPECT_EQ(f.touches, 1);
  EXPECT_DOUBLE_EQ(f.force_step_max_N, 7);
  EXPECT_DOUBLE_EQ(f.surface_way_m, std::hypot(1e-3, 4e-3) + std::hypot(1e-3, 1e-3));
  EXPECT_EQ(f.plane_age_max_ticks, 7);
}

TEST(RunFigures, SumUpTheEffects) {
  std::vector<TickRecord> records = twoTouches();
  records[1].effects = 3;
  records[2].effects = 2;
  EXPECT_EQ(computeFigures(records, 1000).effect_runs, 5);
}

TEST(RunFigures, SumUpTheEnergy) {
  std::vector<TickRecord> records = twoTouches();
  const double energies_J[] = {-0.5e-3, -0.9e-12, -1e-3, 2e-3, 0.5e-3};  // without contact; rounding; active
  for (std::size_t i = 0; i < records.size(); ++i) records[i].energy_J = energies_J[i];
  records[3].damped = true;
  const RunFigures f = computeFigures(records, 1000);
  EXPECT_EQ(f.energy_min_J, -1e-3);
  EXPECT_EQ(f.energy_end_J, 0.5e-3);
  EXPECT_EQ(f.active_ticks, 1);
  EXPECT_EQ(f.damped_ticks, 1);
  records[2].energy_J = -Passivity::kRounding_J;  // rounding at the most
  EXPECT_EQ(computeFigures(records, 1000).active_ticks, 0);
}

TEST(RunFigures, DepthAndSurfaceAreThoseBeforeEffects) {
  TickRecord r = record(1, true, 1, 2e-3);
  r.vhip_W[0] = 5e-3;  // friction has left the VHIP behind
  EXPECT_DOUBLE_EQ(depthOf(r), 2e-3);
  EXPECT_EQ(surfacePointOf(r), Vec3(1e-3, 0, 2e-3));
  r.in_contact = false;
  EXPECT_EQ(depthOf(r), 0);
  EXPECT_EQ(surfacePointOf(r), Vec3(5e-3, 0, 6e-3));
}

// An algorithm without a surface: no depth, and the way is the VHIP's, which is the HIP.
TEST(RunFigures, WithoutASurfaceThereIsNoDepth) {
  std::vector<TickRecord> records = {record(0, true, 1, 0), record(1, true, 1, 0)};
  for (TickRecord& r : records) {
    r.depth_m = std::numeric_limits<double>::quiet_NaN();
    r.vhip_W[0] = r.hip_W[0];
  }
  const RunFigures f = computeFigures(records, 1000);
  EXPECT_EQ(f.depth_m.count, 0U);
  EXPECT_EQ(f.force_N.count, 2U);
  EXPECT_DOUBLE_EQ(f.surface_way_m, 1e-3);
}

TEST(RunFigures, OfNothingAreZero) {
  const RunFigures f = computeFigures({}, 1000);
  EXPECT_EQ(f.ticks, 0);
  EXPECT_EQ(f.force_N.max, 0);
  EXPECT_EQ(f.first_contact_s, -1);
  EXPECT_EQ(f.energy_end_J, 0);
  EXPECT_TRUE(f.faults.empty());
}

}  // namespace run_figures_test
}  // namespace palpate
