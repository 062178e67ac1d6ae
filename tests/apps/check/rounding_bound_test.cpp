// SPDX-License-Identifier: Apache-2.0
// Bounds added up by hand from what rounding_bound.hpp says of each rounding, on fields where few voxels differ.
#include "apps/check/rounding_bound.hpp"

#include <cmath>

#include <gmock/gmock.h>

namespace palpate {
namespace rounding_bound_test {

constexpr double kU = 0x1p-24;  // one rounding
constexpr double kDenormal = 2 * 0x1p-149;
constexpr double kLostWeight = 0x1p-125;
constexpr double kAmple = 1.01;

// 5 x 7 x 5 voxels of one density; the voxel that is asked for is the middle one.
const Vec3i kMiddle(2, 3, 2);

reference::DenseField fieldOf(float density) {
  return {{5, 7, 5}, {}, std::vector<float>(std::size_t{5} * 7 * 5, density)};
}

float& at(reference::DenseField& field, const Vec3i& from_middle) {
  const Vec3i voxel = kMiddle + from_middle;
  return field.values[field.offset(voxel.x(), voxel.y(), voxel.z())];
}

// Weights by the distance along each axis; with both sides their sum over the box is 2 * 1.75 * 1.125.
FilterStep bilateral(float per_range) {
  return {.kind = StepKind::kBilateral, .reach = {1, 2, 1}, .taps = {per_range, 1, 0.5F, 1, 0.25F, 0.125F, 1, 0.0625F}};
}
constexpr double kAllWeights = 2 * 1.75 * 1.125;
constexpr double kCornerWeight = 0.5 * 0.125 * 0.0625;
constexpr int kVoxels = 3 * 5 * 3;

// All are 10 but one corner of the box, which is one range higher (s = 1). The result 10.5 is 0.5 off all of them and
// 2.5 off that one at most: so far each moved weight moves the mean.
TEST(RoundingBound, OfAMeanAddsUpItsWeights) {
  reference::DenseField field = fieldOf(10);
  at(field, {1, -2, 1}) = 12;
  at(field, {2, 0, 0}) = 1e6F;  // beyond the box
  at(field, {0, 3, 0}) = 1e6F;
  const double corner = kCornerWeight * std::exp(-1);
  const double weights = kAllWeights - kCornerWeight + corner;
  const double moved = (kAllWeights - kCornerWeight) * 6.2 * 0.5 + corner * (7 + 6.2) * 2.5;
  const double sums = corner * 2 * (2 * kVoxels + 4);
  const double expected = kAmple * kU * (moved + sums) / weights + 2 * kU * 10.5;
  EXPECT_NEAR(roundingBound(field, kMiddle, bilateral(0.5F), 10.5), expected, 1e-12 * expected);
}

// A corner that is 32 ranges higher has a weight of e^-1024, which no float holds: what is lost is a part of a weight
// below 2^-125, and denormals.
TEST(RoundingBound, OfAMeanCountsWeightsThatAreLost) {
  reference::DenseField field = fieldOf(0);
  at(field, {1, -2, 1}) = 32;
  const double lost = (kCornerWeight * kLostWeight + kDenormal) * 32 + kVoxels * kDenormal;
  const double expected = kAmple * lost / (kAllWeights - kCornerWeight) + kDenormal;
  EXPECT_NEAR(roundingBound(field, kMiddle, bilateral(1), 0), expected, 1e-12 * expected);
}

FilterStep diffusion() {
  return {.kind = StepKind::kDiffuse,
          .reach = Vec3i::Ones(),
          .taps = {0.125F, 0.0625F, 0.03125F, 1, 0.5F, 0.25F},
          .conductance = Conductance::kExp};
}

// Six neighbours, each with a slope of its own.
TEST(RoundingBound, OfADiffusionAddsUpItsFlows) {
  struct Neighbour {
    Vec3i way;
    double rate, slope, difference;
  };
  const Neighbour neighbours[] = {{{1, 0, 0}, 0.125, 1, 1},     {{-1, 0, 0}, 0.125, -2, -2},
                                  {{0, 1, 0}, 0.0625, 2, 4},    {{0, -1, 0}, 0.0625, -1, -2},
                                  {{0, 0, 1}, 0.03125, -1, -4}, {{0, 0, -1}, 0.03125, 3, 12}};
  reference::DenseField field = fieldOf(10);
  double roundings = 0;
  for (const Neighbour& n : neighbours) {
    at(field, n.way) = static_cast<float>(10 + n.difference);
    const double flow = n.rate * std::exp(-n.slope * n.slope) * std::abs(n.difference);
    roundings += flow * (7 * n.slope * n.slope + 5.2 + 5);
  }
  const double expected = kAmple * kU * roundings + 2 * kU * 10.25;
  EXPECT_NEAR(roundingBound(field, kMiddle, diffusion(), 10.25), expected, 1e-12 * expected);
}

TEST(RoundingBound, OfADiffusionCountsFlowsThatAreLost) {
  reference::DenseField field = fieldOf(0);
  at(field, {1, 0, 0}) = 32;
  const double rates = 2 * (0.125 + 0.0625 + 0.03125);
  const double expected = kAmple * (0.125 * kLostWeight * 32 + rates * kDenormal + 6 * kDenormal) + kDenormal;
  EXPECT_NEAR(roundingBound(field, kMiddle, diffusion(), 0), expected, 1e-12 * expected);
}

TEST(RoundingBound, SaysOfWhichFilterItIs) {
  EXPECT_THAT(boundReason(bilateral(1)), testing::StartsWith("bilateral: "));
  EXPECT_THAT(boundReason(diffusion()), testing::StartsWith("diffuse with g=exp: "));
  EXPECT_TRUE(hasExponential(bilateral(1)));
  EXPECT_TRUE(hasExponential(diffusion()));
  FilterStep rational = diffusion();
  rational.conductance = Conductance::kRational;
  EXPECT_FALSE(hasExponential(rational));
}

}  // namespace rounding_bound_test
}  // namespace palpate
