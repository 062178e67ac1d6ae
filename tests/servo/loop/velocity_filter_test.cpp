// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/velocity_filter.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace velocity_filter_test {

TEST(VelocityFilter, WithoutCutoffIsTheBackwardDifference) {
  VelocityFilter filter(0, 1000);
  filter.reset(Vec3::Zero());
  EXPECT_NEAR(filter.update(Vec3(1e-3, 0, 0), 1).x(), 1, 1e-12);
  EXPECT_NEAR(filter.update(Vec3(4e-3, 0, 0), 3).x(), 1, 1e-12);
}

// A ramp from rest: v (1 - e^(-2 pi f_c k T)), the low-pass's step response at the ticks, exactly.
TEST(VelocityFilter, StepResponseIsTheLowPassesOwn) {
  const double cutoff_hz = 50;
  VelocityFilter filter(cutoff_hz, 1000);
  filter.reset(Vec3::Zero());
  for (int k = 1; k <= 50; ++k) {
    const Vec3 v_W = filter.update(Vec3(0, 0.2e-3 * k, 0), 1);
    EXPECT_NEAR(v_W.y(), 0.2 * (1 - std::exp(-2 * M_PI * cutoff_hz * k * 1e-3)), 1e-12);
  }
}

// A gap of three ticks on a ramp ends where three ticks would have.
TEST(VelocityFilter, MissedTicksCountAsTheirTime) {
  VelocityFilter each(80, 1000), gap(80, 1000);
  each.reset(Vec3::Zero());
  gap.reset(Vec3::Zero());
  Vec3 v_W;
  for (int k = 1; k <= 3; ++k) v_W = each.update(Vec3(1e-3 * k, 0, 0), 1);
  EXPECT_NEAR(gap.update(Vec3(3e-3, 0, 0), 3).x(), v_W.x(), 1e-12);
}

}  // namespace velocity_filter_test
}  // namespace palpate
