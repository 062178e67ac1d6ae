// SPDX-License-Identifier: Apache-2.0
// The real servo's limit against the eigenvalues of the sampled loop: the promise of the study, on random loops.
#include "apps/stability/linear_limit.hpp"

#include <gtest/gtest.h>

#include "servo/devices/typical_hands.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace linear_limit_test {

// The search ends within 0.2 % of the limit, the exact bound within 0.1 %; growth of less than some 1e-4 over the
// watched time is not seen, which is some 0.5 % of K at kWatchDecays.
TEST(LinearLimit, IsTheExactOneWithinOnePercent) {
  const WallVolume plane(WallVolume::Shape::kPlane);
  Seeded random(51);
  for (int i = 0; i < 12; ++i) {
    SimulatedLimit what;
    what.loop.hand = kTypicalHands[static_cast<std::size_t>(random.pick(3))].holding(
        {.device_mass_kg = random.logBetween(0.01, 0.5), .device_damping_Ns_per_m = random.logBetween(0.02, 2)});
    what.loop.rate_hz = random.logBetween(500, 5000);
    what.loop.delay_ticks = random.pick(3);
    what.loop.velocity_cutoff_hz = random.pick(3) == 0 ? 0 : random.logBetween(50, 400);
    what.damping_Ns_per_m = random.pick(3) == 0 ? 0 : random.between(0, 0.9) * dampingBound(what.loop, 10);
    what.n = 1 + random.pick(10);
    EXPECT_NEAR(simulatedLimit(what, plane) / stiffnessBound(what.loop, what.damping_Ns_per_m), 1, 0.01)
        << i << " at " << what.loop.rate_hz << " Hz, B " << what.damping_Ns_per_m << ", delay "
        << what.loop.delay_ticks;
  }
}

TEST(LinearLimit, IsZeroWhereNoWallIsStable) {
  const WallVolume plane(WallVolume::Shape::kPlane);
  SimulatedLimit what;
  what.damping_Ns_per_m = 3 * dampingBound(what.loop, 10);
  EXPECT_EQ(simulatedLimit(what, plane), 0);
}

}  // namespace linear_limit_test
}  // namespace palpate
