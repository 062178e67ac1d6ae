// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_step.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "shaders/filter_distance.layout.h"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace filter_step_test {

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
  const auto refusal = [](const char* chain, const Vec3& spacing_m) {
    return refusalOf([&] { static_cast<void>(lowerFilters(filterChain(chain), spacing_m)); });
  };
  EXPECT_EQ(refusal("gaussian:11", Vec3::Ones()),
            "gaussian of 11 voxels: along axis i it reaches 33 voxels; 32 are possible; make it smaller");
  EXPECT_EQ(refusal("gaussian:1m", {1, 1, 1e-3}),
            "gaussian of 1000 mm: along axis k it reaches 3000 voxels; 32 are possible; make it smaller");
  EXPECT_EQ(refusal("bilateral:4.5:range=5", Vec3::Ones()),
            "bilateral of 4.5 voxels: along axis i it reaches 9 voxels; 8 are possible; make it smaller");
}

TEST(LowerFilters, KeepTheBorderAndTheConductance) {
  const auto chain = filterChain("gaussian:1:border=mirror bilateral:1:range=5:border=mirror median:1:border=mirror");
  const auto mirrored = lowerFilters(chain, Vec3::Ones());
  ASSERT_EQ(mirrored.size(), 5U);
  for (const FilterStep& step : mirrored) EXPECT_EQ(step.border, Border::kMirror);
  EXPECT_EQ(lowerFilters(filterChain("diffuse:1:kappa=1:g=exp"), Vec3::Ones()).at(0).conductance, Conductance::kExp);
  EXPECT_EQ(lowerFilters(filterChain("diffuse:1:kappa=1"), Vec3::Ones()).at(0).conductance, Conductance::kRational);
}

TEST(UniformResult, KeepsAConstantToItsRounding) {
  const auto steps = lowerFilters(filterChain("gaussian:1.5"), Vec3::Constant(1e-3));
  // Eleven taps: eleven products and ten sums, each off by half an ULP at most, and the taps' own rounding.
  for (const float density : {0.0F, 1.0F, -1000.0F, 3e38F, 1e-40F}) {
    EXPECT_NEAR(uniformResult(steps[0], density), density, std::abs(density) * 22 * std::ldexp(1, -24) + 1e-44);
  }
}

TEST(LowerFilters, BilateralHasABoxOfTaps) {
  const auto steps = lowerFilters(filterChain("bilateral:1mm:range=50"), {0.5e-3, 1e-3, 2e-3});
  ASSERT_EQ(steps.size(), 1U);
  EXPECT_EQ(steps[0].reach, Vec3i(4, 2, 1));
  ASSERT_EQ(steps[0].taps.size(), 1U + 5 + 3 + 2);
  EXPECT_FLOAT_EQ(steps[0].taps[0], static_cast<float>(1 / (std::sqrt(2.0) * 50)));
  // Behind that the taps of sigma 2, 1 and 1/2 voxel: neighbours are samples of one Gaussian, and each axis sums to
  // one.
  std::size_t at = 1;
  for (const double sigma : {2.0, 1.0, 0.5}) {
    const int reach = static_cast<int>(2 * sigma);
    double sum = steps[0].taps[at];
    for (std::size_t x = 1; x <= static_cast<std::size_t>(reach); ++x) {
      const double step = static_cast<double>(x * x) / (2 * sigma * sigma);
      EXPECT_NEAR(steps[0].taps[at + x] / steps[0].taps[at], std::exp(-step), 2e-7) << sigma << " " << x;
      sum += 2.0 * steps[0].taps[at + x];
    }
    EXPECT_NEAR(sum, 1, 9 * std::ldexp(1, -25)) << sigma;
    at += static_cast<std::size_t>(reach) + 1;
  }
  EXPECT_TRUE(lowerFilters(filterChain("bilateral:0.1:range=5"), Vec3::Ones()).empty());
  EXPECT_NO_THROW((void)lowerFilters(filterChain("bilateral:4:range=5"), Vec3::Ones()));
  EXPECT_THROW((void)lowerFilters(filterChain("bilateral:4.1:range=5"), Vec3::Ones()), Error);
}

// 1 / (2 (1 + 1/4 + 1/16)) mm^2 for voxels of 1, 2 and 4 mm.
TEST(LowerFilters, DiffusionIsRefusedBeyondItsStableStep) {
  const Vec3 spacing_m(1e-3, 2e-3, 4e-3);
  const double bound = 1 / (2 * 1.3125);
  EXPECT_NEAR(stableTimeStep(spacing_m), bound, 1e-15);
  const auto steps = lowerFilters(filterChain("diffuse:7:kappa=10"), spacing_m);
  ASSERT_EQ(steps.size(), 7U);
  EXPECT_EQ(totalReach(steps), Vec3i::Constant(7));
  const double rates[3] = {bound / 2, bound / 8, bound / 32};
  const double slopes[3] = {0.1, 0.05, 0.025};  // 1 / (10 a mm times 1, 2, 4 mm)
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_FLOAT_EQ(steps[3].taps[axis], static_cast<float>(rates[axis]));
    EXPECT_FLOAT_EQ(steps[3].taps[3 + axis], static_cast<float>(slopes[axis]));
  }
  EXPECT_NO_THROW((void)lowerFilters(filterChain("diffuse:1:kappa=1:dt=0.38"), spacing_m));
  try {
    (void)lowerFilters(filterChain("diffuse:1:kappa=1:dt=0.382"), spacing_m);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "filter diffuse with dt=0.382: with these voxels a time step is stable up to 0.380952 mm^2; "
                 "make dt smaller, or leave it out for half of that");
  }
}

TEST(LowerFilters, DistanceNeedsAnIsovalue) {
  const Vec3 spacing_m(1e-3, 2e-3, 0.5e-3);
  EXPECT_THROW((void)lowerFilters(filterChain("distance:4"), spacing_m), Error);
  const auto steps = lowerFilters(filterChain("distance:4 distance:2"), spacing_m, 226.0F);
  ASSERT_EQ(steps.size(), 2U * kDistanceSteps);
  EXPECT_EQ(distanceBand(steps[0]), 4 * 0.5e-3F);
  // Above its isovalue is object; the second one begins at 0.
  const auto first = static_cast<std::size_t>(kDistanceSteps - 1);
  EXPECT_EQ(uniformResult(steps[first], 226.5F), 4 * 0.5e-3F);
  EXPECT_EQ(uniformResult(steps[first], 226.0F), -4 * 0.5e-3F);
  EXPECT_EQ(uniformResult(steps[2 * first + 1], 1.0F), 2 * 0.5e-3F);
  // Seeds look at neighbours; a band of 2 mm is 2, 1 and 4 voxels, and a surface point may be known one further.
  const std::span<const FilterStep> one = std::span(steps).first(kDistanceSteps);
  EXPECT_EQ(totalReach(one), Vec3i(2, 1, 4) + 3 * Vec3i::Ones());
}

// Lengths in the smallest spacing: edges of 2, 4 and 1, half a diagonal of sqrt(21) / 2, and the band of 4.
TEST(LowerFilters, ADistanceIsASeedASpreadAlongEachAxisAndAnEnd) {
  const auto steps = lowerFilters(filterChain("distance:4"), {1e-3, 2e-3, 0.5e-3}, 226.0F);
  ASSERT_EQ(steps.size(), static_cast<std::size_t>(kDistanceSteps));
  const StepKind kinds[] = {StepKind::kDistanceSeed, StepKind::kDistanceSpread, StepKind::kDistanceSpread,
                            StepKind::kDistanceSpread, StepKind::kDistanceFinish};
  const Vec3i reaches[] = {{1, 1, 1}, {3, 0, 0}, {0, 2, 0}, {0, 0, 5}, {1, 1, 1}};
  const int axes[] = {0, 0, 1, 2, 0};
  for (std::size_t n = 0; n < steps.size(); ++n) {
    EXPECT_EQ(steps[n].kind, kinds[n]) << n;
    EXPECT_EQ(steps[n].reach, reaches[n]) << n;
    EXPECT_EQ(steps[n].axis, axes[n]) << n;
    EXPECT_EQ(steps[n].border, Border::kNearest) << n;
    const std::vector<float>& taps = steps[n].taps;
    ASSERT_EQ(taps.size(), static_cast<std::size_t>(DISTANCE_TAPS)) << n;
    EXPECT_EQ(taps[DISTANCE_ISOVALUE], 226) << n;
    EXPECT_EQ(taps[DISTANCE_BAND], 4) << n;
    EXPECT_EQ(taps[DISTANCE_UNIT], 0.5e-3F) << n;
    EXPECT_FLOAT_EQ(taps[DISTANCE_SLACK], static_cast<float>(std::sqrt(21.0) / 2)) << n;
    const float edges[] = {2, 4, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(taps[DISTANCE_EDGE + axis], edges[axis]) << n;
      EXPECT_EQ(taps[DISTANCE_EDGE_SQUARE + axis], edges[axis] * edges[axis]) << n;
    }
    if (n + 1 < steps.size()) {
      EXPECT_EQ(uniformResult(steps[n], 300.0F), 0) << n;  // no surface is near
    }
  }
}

TEST(UniformResult, OfFiltersThatKeepEdgesIsTheDensity) {
  for (const char* chain : {"bilateral:1:range=5", "diffuse:1:kappa=5", "diffuse:1:kappa=5:g=exp"}) {
    const FilterStep step = lowerFilters(filterChain(chain), Vec3::Constant(1e-3)).at(0);
    for (const float density : {0.0F, -0.0F, 1.0F, -1000.7F, 3e38F, 1e-40F}) {
      EXPECT_EQ(uniformResult(step, density), density);
      EXPECT_FALSE(density == 0 && std::signbit(uniformResult(step, density)));  // zero is added
    }
  }
}

}  // namespace filter_step_test
}  // namespace palpate
