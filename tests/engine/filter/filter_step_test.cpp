// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_step.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace {

double sumOf(const FilterStep& step) {
  double sum = step.taps[0];
  for (std::size_t i = 1; i < step.taps.size(); ++i) sum += 2.0 * step.taps[i];
  return sum;
}

// A length gives each axis its own number of voxels; three sigmas are reached, rounded up.
TEST(LowerFilters, GaussianRespectsTheSpacing) {
  const auto steps = lowerFilters(filterChain("gaussian:1mm"), {0.5e-3, 1e-3, 2e-3});
  ASSERT_EQ(steps.size(), 3U);
  const int reach[3] = {6, 3, 2};
  const double sigma[3] = {2, 1, 0.5};
  for (int axis = 0; axis < 3; ++axis) {
    const FilterStep& step = steps[static_cast<std::size_t>(axis)];
    EXPECT_EQ(step.axis, axis);
    EXPECT_EQ(step.reach, reach[axis] * Vec3i::Unit(axis));
    // Each tap is rounded by half an ULP of at most 2^-25, and there are 2 * 6 + 1 of them at most.
    EXPECT_NEAR(sumOf(step), 1, 13 * std::ldexp(1, -25));
    // Neighbouring taps are samples of one Gaussian.
    EXPECT_NEAR(step.taps[1] / step.taps[0], std::exp(-0.5 / (sigma[axis] * sigma[axis])), 2e-7);
  }
  EXPECT_EQ(totalReach(steps), Vec3i(6, 3, 2));
}

TEST(LowerFilters, LeavesOutWhatChangesNothing) {
  // 0.1 voxels: exp(-50) of the middle tap goes aside, which no float shows.
  EXPECT_TRUE(lowerFilters(filterChain("gaussian:0.1"), Vec3::Constant(1e-3)).empty());
  // The thick slices' axis alone is left out.
  EXPECT_EQ(lowerFilters(filterChain("gaussian:1mm"), {1e-3, 1e-3, 10e-3}).size(), 2U);
}

TEST(LowerFilters, RefusesWhatReachesTooFar) {
  EXPECT_NO_THROW((void)lowerFilters(filterChain("gaussian:10"), Vec3::Constant(1e-3)));
  EXPECT_THROW((void)lowerFilters(filterChain("gaussian:11"), Vec3::Constant(1e-3)), Error);
  EXPECT_THROW((void)lowerFilters(filterChain("gaussian:1m"), Vec3::Constant(1e-3)), Error);
}

TEST(UniformResult, KeepsAConstantToItsRounding) {
  const auto steps = lowerFilters(filterChain("gaussian:1.5"), Vec3::Constant(1e-3));
  // Eleven taps: eleven products and ten sums, each off by half an ULP at most, and the taps' own rounding.
  for (const float density : {0.0F, 1.0F, -1000.0F, 3e38F, 1e-40F}) {
    EXPECT_NEAR(uniformResult(steps[0], density), density, std::abs(density) * 22 * std::ldexp(1, -24) + 1e-44);
  }
}

}  // namespace
}  // namespace palpate
