// SPDX-License-Identifier: Apache-2.0
// Errors that were put in by hand must come out. Truth: the sphere's exact distance; tolerances are rounding (1e-9) and
// what the level set is met to (1e-6 voxel).
#include "apps/bench/touch_errors.hpp"

#include <gtest/gtest.h>

#include "base/units.hpp"
#include "oracle.hpp"

namespace palpate {
namespace {

class TouchErrorsOf : public testing::Test {
 protected:
  [[nodiscard]] TouchErrors of(OracleErrors errors) const {
    auto entrants = oneEntrant(std::make_unique<Oracle>(volume_.phantom(), std::move(errors)));
    return touchErrors(volume_, path_, entrants, [](double) {}).front();
  }

  BenchVolume volume_{"phantom:sphere?size=64"};
  ContactPath path_ = contactPath(volume_, {.ticks = 500});
};

TEST_F(TouchErrorsOf, AnExactAlgorithmAreNone) {
  const TouchErrors errors = of({});
  EXPECT_EQ(errors.ticks, 470);
  EXPECT_EQ(errors.contact_ticks, 470);
  EXPECT_EQ(errors.vhip_voxel.count, 470U);
  EXPECT_LT(errors.vhip_voxel.max, 1e-9);
  EXPECT_LT(errors.force_percent.max, 1e-9);
  EXPECT_LT(errors.angle_deg.max, 1e-6);
  EXPECT_EQ(errors.missed_ticks, 0);
  EXPECT_EQ(errors.falls, 0);
  EXPECT_NEAR(errors.force_jump_max_N, errors.exact_force_jump_max_N, 1e-9);
  EXPECT_NEAR(errors.force_mean_N, 0.5, 1e-6);  // 1 mm at 500 N/m
}

TEST_F(TouchErrorsOf, ALiftedVhipIsTheLift) {
  const TouchErrors errors = of({.lift_m = 0.2e-3});
  EXPECT_NEAR(errors.vhip_voxel.p50, 0.2, 1e-6);
  EXPECT_NEAR(of({.lift_m = -0.2e-3}).vhip_voxel.p99, 0.2, 1e-6);
  EXPECT_LT(errors.angle_deg.max, 1e-6);
}

TEST_F(TouchErrorsOf, AWrongForceIsThatShare) {
  EXPECT_NEAR(of({.force_share = 0.07}).force_percent.p50, 7, 1e-6);
  EXPECT_NEAR(of({.force_share = -0.07}).force_percent.p99, 7, 1e-6);
}

TEST_F(TouchErrorsOf, ATurnedForceIsThatAngle) {
  const TouchErrors errors = of({.turn_rad = 3 / kDegreesPerRadian});
  EXPECT_NEAR(errors.angle_deg.p50, 3, 1e-6);
  EXPECT_NEAR(errors.angle_deg.max, 3, 1e-6);
}

// Blind in two stretches of 10 and 5 ticks: two falls; the force of 0.5 N goes and comes at once.
TEST_F(TouchErrorsOf, LostContactIsCountedByTickAndByFall) {
  const TouchErrors errors =
      of({.blind = [](int tick, double) { return (tick >= 100 && tick < 110) || (tick >= 200 && tick < 205); }});
  EXPECT_EQ(errors.missed_ticks, 15);
  EXPECT_EQ(errors.falls, 2);
  EXPECT_EQ(errors.contact_ticks, 455);
  EXPECT_NEAR(errors.force_jump_max_N, 0.5, 1e-6);
  EXPECT_LT(errors.exact_force_jump_max_N, 0.01);
}

// 0.25 voxel below the surface is not yet missed.
TEST_F(TouchErrorsOf, AShallowBlindnessIsNotCounted) {
  EXPECT_EQ(of({.blind = [](int, double depth_m) { return depth_m < 0.2e-3; }}).missed_ticks, 0);
  EXPECT_GT(of({.blind = [](int, double depth_m) { return depth_m < 0.5e-3; }}).missed_ticks, 0);
}

TEST_F(TouchErrorsOf, AnAlgorithmThatNeverTouchesHasNoErrorsButMisses) {
  const TouchErrors errors = of({.blind = [](int, double) { return true; }});
  EXPECT_EQ(errors.contact_ticks, 0);
  EXPECT_EQ(errors.vhip_voxel.count, 0U);
  EXPECT_EQ(errors.falls, 1);
  EXPECT_GE(errors.missed_ticks, 470);
}

}  // namespace
}  // namespace palpate
