// SPDX-License-Identifier: Apache-2.0
// tests/servo/algorithms/level_leap.hpp: a leap aside over level ground: how far an algorithm that goes along the
// surface gets in one tick.
#pragma once

#include <algorithm>

#include <gtest/gtest.h>

#include "support/algorithm_driver.hpp"
#include "support/analytic_surface.hpp"

namespace palpate {

// Checks that the contact follows the HIP by at most `farthest_m` in a tick. Without a window the algorithm still names
// the place that it reached. Floats of up to 0.03 put heights off by 1e-9.
template <typename SurfaceAlgorithm>
void expectToGetAsFarAsATickAllows(double farthest_m) {
  const AnalyticVolume ground = millimetreVolume([](const Vec3& p_W) { return 20.3e-3 - p_W.z(); }, 48);
  const auto at = [](double x_m, double z_m) { return Vec3(x_m, 24e-3, z_m); };
  const SampleWindow nothing;
  for (const double leap_m : {0.5e-3, 10e-3, farthest_m, 30e-3}) {
    SurfaceAlgorithm algorithm(AlgorithmParameters{0, 500, 0, 1});
    AlgorithmDriver driver(algorithm, ground, at(10e-3, 21e-3), 48);
    driver.follow = false;
    driver.at(at(10e-3, 21e-3));
    ASSERT_TRUE(driver.at(at(10e-3, 19e-3)).in_contact);
    const Vec3 hip_W = at(10e-3 + leap_m, 19e-3);
    ASSERT_TRUE(driver.at(hip_W).in_contact);
    TickOutput out;
    algorithm.tick({hip_W, Vec3::Zero(), &nothing}, out);
    ASSERT_TRUE(out.at_surface);
    EXPECT_LT((out.surface_W - at(10e-3 + std::min(leap_m, farthest_m), 20.3e-3)).norm(), 1e-7) << leap_m;
  }
}

}  // namespace palpate
