// SPDX-License-Identifier: Apache-2.0
#include "apps/report/run_figures.hpp"

#include <gtest/gtest.h>

#include "sample_run.hpp"

namespace palpate {
namespace {

// Two touches by hand: depths 1, 3 mm, then free, then 2 mm; 500 N/m; 1 mm sideways between ticks.
std::vector<TickRecord> twoTouches() {
  return {pressedTick(0, 1000, 0e-3, -1e-3), pressedTick(1, 1000, 1e-3, 1e-3), pressedTick(2, 1000, 2e-3, 3e-3),
          pressedTick(3, 1000, 3e-3, -1e-3), pressedTick(4, 1000, 4e-3, 2e-3)};
}

TEST(RunFigures, CountContactForceAndDepth) {
  const RunFigures f = computeFigures(twoTouches(), 1000);
  EXPECT_EQ(f.ticks, 5);
  EXPECT_EQ(f.contact_ticks, 3);
  EXPECT_EQ(f.touches, 2);
  EXPECT_DOUBLE_EQ(f.contact_s, 3e-3);
  EXPECT_DOUBLE_EQ(f.first_contact_s, 1e-3);
  EXPECT_DOUBLE_EQ(f.depth_m.p50, 2e-3);
  EXPECT_DOUBLE_EQ(f.depth_m.max, 3e-3);
  EXPECT_DOUBLE_EQ(f.force_N.max, 1.5);
  EXPECT_DOUBLE_EQ(f.force_step_max_N, 1.5);  // from 1.5 N to none
  EXPECT_DOUBLE_EQ(f.vhip_way_m, 1e-3);       // within the first touch only
}

TEST(RunFigures, CountLateAndFaultyTicks) {
  auto records = twoTouches();
  for (TickRecord& r : records) r.lateness_ns = 10'000;
  records[1].lateness_ns = 999'000;  // with 2 us or more of work the next tick is due before this one ends
  records[3].faults = 4;
  const RunFigures f = computeFigures(records, 1000);
  EXPECT_EQ(f.late_ticks, 1);
  EXPECT_EQ(f.faulty_ticks, 1);
  EXPECT_DOUBLE_EQ(f.lateness_us.max, 999);
  EXPECT_DOUBLE_EQ(f.lateness_us.p50, 10);
}

TEST(RunFigures, DepthIsMeasuredAlongTheNormal) {
  TickRecord r = pressedTick(0, 1000, 0, 2e-3);
  r.vhip_W[0] = 5e-3;  // friction has left the VHIP behind
  EXPECT_DOUBLE_EQ(depthOf(r), 2e-3);
}

TEST(RunFigures, OfNothingAreZero) {
  const RunFigures f = computeFigures({}, 1000);
  EXPECT_EQ(f.ticks, 0);
  EXPECT_EQ(f.force_N.max, 0);
  EXPECT_EQ(f.first_contact_s, -1);
}

}  // namespace
}  // namespace palpate
