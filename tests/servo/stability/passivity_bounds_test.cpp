// SPDX-License-Identifier: Apache-2.0
#include "servo/stability/passivity_bounds.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "servo/stability/sampled_loop.hpp"

namespace palpate {
namespace passivity_bounds_test {

// b = 0.1 N s/m at 1 kHz bears 200 N/m; half of it goes into B = 0.05.
TEST(PassivityBounds, AreThoseOfTheFormulas) {
  const PassiveDevice device = {
      .damping_Ns_per_m = 0.1, .coulomb_friction_N = 0.05, .resolution_m = 50e-6, .rate_hz = 1000};
  EXPECT_DOUBLE_EQ(samplingBound(device, 0), 200);
  EXPECT_DOUBLE_EQ(samplingBound(device, 0.05), 100);
  EXPECT_DOUBLE_EQ(samplingBound(device, -0.05), 100);
  EXPECT_EQ(samplingBound(device, 0.2), 0);
  EXPECT_DOUBLE_EQ(quantisationBound(device), 2000);
  EXPECT_DOUBLE_EQ(passiveStiffness(device, 0), 200);
  PassiveDevice coarse = device;
  coarse.resolution_m = 1e-3;
  EXPECT_DOUBLE_EQ(passiveStiffness(coarse, 0), 100);
  coarse.resolution_m = 0;
  EXPECT_TRUE(std::isinf(quantisationBound(coarse)));
}

// A passive wall is stable in any hand that is passive itself: below the bound no eigenvalue lies outside, whatever
// mass, damping and spring the hand has. The bound is for an undelayed force and the bare backward difference.
TEST(PassivityBounds, BelowThemEveryHandIsStable) {
  std::mt19937 random(5);
  const auto decades = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  for (int i = 0; i < 1000; ++i) {
    SampledLoop loop;
    loop.hand = {decades(1e-3, 10), decades(1e-3, 100), decades(1, 1e4), decades(1e-2, 10), decades(1e-2, 20)};
    loop.rate_hz = decades(100, 20000);
    loop.velocity_cutoff_hz = 0;
    const PassiveDevice device = {.damping_Ns_per_m = loop.hand.device_damping_Ns_per_m, .rate_hz = loop.rate_hz};
    const double damping = decades(1e-4, 1) * device.damping_Ns_per_m;
    EXPECT_TRUE(isStable(loop, {0.999 * samplingBound(device, damping), damping})) << i;
  }
}

}  // namespace passivity_bounds_test
}  // namespace palpate
