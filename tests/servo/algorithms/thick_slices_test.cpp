// SPDX-License-Identifier: Apache-2.0
// Masks of thick slices: a binary ball of 20 mm in slices of 1 to 6 mm with pixels of 0.3 and 0.4 mm is a stack of
// discs, whose steps are up to twenty pixels high. A tool pressed into it and led over it is held all the time.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "servo/algorithms/hri.hpp"
#include "servo/safety/faults.hpp"
#include "servo/window/window_sampler.hpp"
#include "support/algorithm_driver.hpp"
#include "support/sampled_volume.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace thick_slices_test {

constexpr double kRadius = 20e-3;

struct Slices {
  double pixel_m, slice_m;
};

// Ticks of a slide without contact although the HIP is in the object, or with a fault that takes the force away.
int lostTicks(const Slices& slices, unsigned seed) {
  Seeded random(31 * seed);
  const Vec3 centre_W = random.inCube(3e-3);
  const Mat3 R_WL = seed % 3 == 0 ? random.axes(false) : Mat3::Identity();
  const Vec3 spacing_m(slices.pixel_m, slices.pixel_m, slices.slice_m);
  Sampling sampling{.size = Vec3(56e-3, 56e-3, 70e-3).cwiseQuotient(spacing_m).array().ceil().cast<int>(), .flat_m = 1};
  sampling.lattice = latticeAround(Vec3::Zero(), sampling.size, spacing_m, R_WL);
  AnalyticVolume volume = sampledOn(sampling, ballSurface(centre_W, kRadius));
  volume.density = [exact = volume.density](const Vec3& p_W) { return exact(p_W) > 0 ? 0.5 : -0.5; };
  const double depth_m = random.logBetween(2e-3, 9e-3);
  const int n = static_cast<int>(random.logBetween(1, 11));
  const double step_m = random.logBetween(0.03e-3, 0.3e-3);
  const Vec3 out_W = random.direction(), aside_W = random.across(out_W);
  const auto at = [&](double angle, double deep_m) {
    return Vec3(centre_W + (out_W * std::cos(angle) + aside_W * std::sin(angle)) * (kRadius - deep_m));
  };
  Hri hri({.damping_Ns_per_m = 0, .plane_renewal_ticks = n});
  AlgorithmDriver driver(hri, volume, at(0, -7e-3));
  driver.around_vhip = true;
  for (double deep_m = -7e-3; deep_m < depth_m; deep_m += 0.1e-3) driver.at(at(0, deep_m));
  int lost = 0;
  for (double angle = 0; angle < 2; angle += step_m / (kRadius - depth_m)) {
    const Vec3 hip_W = at(angle, depth_m);
    const TickOutput out = driver.at(hip_W);
    const bool is_inside = fetch(driver.window(), hip_W).density > 0;
    if ((is_inside && !out.in_contact) || (out.faults & kFadingFaults) != 0) ++lost;
  }
  return lost;
}

// On the code before, 5 of 80 such slides lost the surface, for up to 123 ticks of some 380.
TEST(ThickSlices, HoldATool) {
  for (const Slices& slices :
       {Slices{0.3e-3, 1e-3}, Slices{0.4e-3, 3e-3}, Slices{0.4e-3, 5e-3}, Slices{0.4e-3, 6e-3}}) {
    for (unsigned seed = 1; seed <= (isLongRun() ? 1000U : 40U); ++seed)
      EXPECT_EQ(lostTicks(slices, seed), 0) << slices.pixel_m << " x " << slices.slice_m << ", seed " << seed;
  }
}

}  // namespace thick_slices_test
}  // namespace palpate
