// SPDX-License-Identifier: Apache-2.0
// Bilateral filter and anisotropic diffusion: bits and bounds against the twin and the kernels' text, and formulas.
#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "engine/reference/filter.hpp"
#include "filtered_fields.hpp"
#include "filters_by_text.hpp"
#include "shaders/kernel_text.hpp"

namespace palpate {
namespace filter_edge_test {

using reference::DenseField;

std::vector<FilterStep> stepsOf(const std::string& chain, const Vec3& spacing_m = testLattice().spacing_m) {
  return lowerFilters(filterChain(chain), spacing_m, 0.0F);
}

const double kRounding = std::ldexp(1, -24);  // of one operation, as a share of its result

struct Case {
  std::string chain;
  Vec3i size;
};

// ---- Rational diffusion: + - * / alone, so the twin agrees bit for bit.

class DiffusionBits : public testing::TestWithParam<Case> {};

TEST_P(DiffusionBits, EqualTheTwin) {
  const auto steps = stepsOf(GetParam().chain);
  for (const Volume& volume : {ballField(GetParam().size, 9.0), extremes(GetParam().size)}) {
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::applyFilters(reference::denseField(volume), steps)),
              0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Chains, DiffusionBits,
                         testing::Values(Case{"diffuse:1:kappa=1", {41, 33, 37}},
                                         Case{"diffuse:4:kappa=0.2", {24, 40, 17}},
                                         Case{"diffuse:2:kappa=1:dt=0.1", {2, 30, 9}},
                                         Case{"diffuse:2:kappa=1", {2, 2, 2}}, Case{"diffuse:2:kappa=1", {9, 1, 17}},
                                         Case{"diffuse:2:kappa=1", {1, 9, 17}}, Case{"diffuse:2:kappa=3", {9, 8, 2}},
                                         Case{"diffuse:1:kappa=1e-20", {17, 16, 15}},
                                         Case{"gaussian:1 diffuse:2:kappa=1 gaussian:0.6", {30, 20, 25}}));

// ---- The exponential: against the library's, and through it the kernels' text.

// 2^p: the polynomial is off by 0.16 * 2^-24 of the value; the sum that ends it is below 1.42 and its last product
// below 0.42, which three more roundings (of that product, of the sum before and of the one before that, smaller by
// 0.35 each time) moved by 0.42 * (1 + 1 + 0.35) * 2^-24 at most; the last rounding moves it by half an ULP. Together
// 0.16 + 1.0 + 1 times 2^-24 of at most 1.42, against a value of at least 0.707: 2.2 / 0.707 * 1.0 < 3.2 * 2^-24.
TEST(FilterText, TwoToThePowerIsCloseToTheLibrarys) {
  double worst = 0;
  for (int i = 0; i <= 2000000; ++i) {
    const auto p = static_cast<float>(-125.0 * i / 2000000);
    const double truth = std::exp2(static_cast<double>(p));
    worst = std::max(worst, std::abs(kernel_text::exp2Below(p) - truth) / truth);
  }
  EXPECT_LE(worst, 3.2 * kRounding);
  RecordProperty("worst_in_2^-24", std::to_string(worst / kRounding));
  EXPECT_EQ(kernel_text::exp2Below(0.0F), 1.0F);
  EXPECT_EQ(kernel_text::exp2Below(-0.0F), 1.0F);
  EXPECT_EQ(kernel_text::exp2Below(-125.001F), 0.0F);
  EXPECT_EQ(kernel_text::exp2Below(-INFINITY), 0.0F);
  EXPECT_EQ(kernel_text::exp2Below(NAN), 0.0F);
}

// exp(-s^2): the exponent is off by three roundings of itself (gaussianOf), which moves the value by their sum times
// the exponent, and 2^p by 3.2 * 2^-24 more.
TEST(FilterText, GaussianIsCloseToTheLibrarys) {
  for (int i = 0; i <= 100000; ++i) {
    const auto s = static_cast<float>(9.2 * i / 100000);
    const double square = static_cast<double>(s) * s;
    const double truth = std::exp(-square);
    EXPECT_LE(std::abs(kernel_text::gaussianOf(s) - truth), (3.2 + 3.01 * square) * kRounding * truth) << s;
  }
  EXPECT_EQ(kernel_text::gaussianOf(INFINITY), 0.0F);
}

class ExponentialBits : public testing::TestWithParam<Case> {};

TEST_P(ExponentialBits, EqualTheTextOnTheCpu) {
  const auto steps = stepsOf(GetParam().chain);
  for (const Volume& volume : {ballField(GetParam().size, 9.0), extremes(GetParam().size)}) {
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), by_text::filtered(reference::denseField(volume), steps)), 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Chains, ExponentialBits,
    testing::Values(Case{"bilateral:1:range=200", {1, 9, 17}}, Case{"bilateral:1:range=1", {41, 33, 25}},
                    Case{"bilateral:1:range=1:border=mirror", {25, 33, 17}},
                    Case{"bilateral:1.5mm:range=0.5", {40, 24, 24}}, Case{"bilateral:3:range=2:truncate=1", {20, 3, 2}},
                    Case{"bilateral:1.5:range=2:border=mirror", {3, 2, 11}},
                    Case{"bilateral:0.9:range=1e20", {10, 9, 17}}, Case{"diffuse:2:kappa=1:g=exp", {41, 33, 17}},
                    Case{"diffuse:2:kappa=0.5:g=exp", {2, 2, 9}}));

// ---- Against the twin, which takes exponentials in double. (Of a bilateral mean: tests/apps/check, voxel by voxel.)

// One step of g = exp: a flow is off by (7 s^2 + 3.2 + 2) u of itself; s^2 exp(-s^2) <= 1/e and |d| <= 6 here, so a
// flow is off by (7 * 0.37 + 5.2) u * 6 < 47 u; times its rate (the six of which sum to 1/2 for the default step), and
// the four sums of values below 6 by u each of it, of which the last, of values up to 3, counts in full on either side.
TEST(Diffusion, WithAnExponentialIsAsCloseToTheTwin) {
  const FilterStep step = stepsOf("diffuse:1:kappa=1:g=exp").at(0);
  const Volume volume = ballField({30, 27, 25}, 9.0);
  const DenseField gpu = filteredOnGpu(volume, {step});
  const DenseField twin = reference::applyStep(reference::denseField(volume), step);
  for (std::size_t i = 0; i < gpu.values.size(); ++i)
    ASSERT_NEAR(gpu.values[i], twin.values[i], (47 * 0.5 + 4 * 3 + 2 * 3) * kRounding);
}

// ---- What they do.

TEST(Bilateral, KeepsAConstant) {
  for (const float density : {0.0F, 1.0F, -1000.7F, 3e38F, 1e-40F}) {
    const Volume volume = makeField({12, 11, 10}, [=](int, int, int) { return density; });
    const DenseField after = filteredOnGpu(volume, stepsOf("bilateral:1:range=5"));
    EXPECT_EQ(differing(after, reference::denseField(volume)), 0U) << density;
  }
}

// Neighbours of the largest densities of both signs differ by infinity, which counts for nothing: every voxel keeps its
// density, since all that lie within range hold the same.
TEST(Filters, TakeNothingFromDifferencesThatOverflow) {
  const Volume volume = makeField({18, 10, 11}, [](int i, int, int) { return i < 9 ? 3e38F : -3e38F; });
  for (const char* chain : {"bilateral:1:range=1e20", "diffuse:2:kappa=1e10", "diffuse:2:kappa=1e10:g=exp"}) {
    const auto steps = stepsOf(chain);
    EXPECT_EQ(differing(filteredOnGpu(volume, steps), reference::denseField(volume)), 0U) << chain;
  }
}

// A step of height 40 with range 4: what lies on the other side weighs exp(-50) of what lies on this one, at most so
// much altogether relative to this side's weight; the side itself holds at least the voxel's own plane, whose taps
// outweigh each other plane's, so with reach 2 the other side has at most two planes of at most its weight each.
TEST(Bilateral, KeepsAStepMuchHigherThanItsRange) {
  const auto height = [](int i) { return i < 10 ? 10.0F : 50.0F; };
  const Volume volume = makeField({20, 9, 9}, [&](int i, int, int) { return height(i); });
  const DenseField after = filteredOnGpu(volume, stepsOf("bilateral:1:range=4"));
  const double bound = 2 * std::exp(-50.0) * 40 + 50 * kRounding;
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(after.at(i, 4, 4), height(i), bound) << i;
}

// With a range of 1e6 times the differences every weight of density is 1 - 1e-12 at least: a Gaussian of the same
// window. Its taps sum to one up to rounding, (2 * 2 + 1) * 2^-25 an axis; both add 5^3 or three times 5 values up
// to 3.
TEST(Bilateral, WithAHugeRangeIsTheGaussian) {
  const Volume volume = ballField({30, 27, 25}, 9.0);
  const DenseField a = filteredOnGpu(volume, stepsOf("bilateral:1:range=1e7"));
  const DenseField b = filteredOnGpu(volume, stepsOf("gaussian:1:truncate=2"));
  const double taps = 3 * 5 * kRounding / 2;
  const double sums = (3 * 2 * 5 + 2 * 125 * 2) * kRounding;  // differences are up to twice as large as values
  for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 3 * (taps + sums + 1e-11));
}

double sumOf(const DenseField& field) {
  double sum = 0;
  for (const float value : field.values) sum += value;
  return sum;
}

// What leaves a voxel through a face enters the next, so only roundings are lost: a voxel's six flows, their three sums
// along axes, two of those and the last one, u each of values below 50. A ramp, so that flows in the two directions do
// not cancel each other by symmetry.
TEST(Diffusion, KeepsTheMean) {
  const Volume volume = makeField({33, 30, 27}, [](int i, int j, int k) {
    return static_cast<float>(i + 0.5 * j + ((i + j) % 3 == 0 ? 1.0 : 0.0) + 0.1 * (k % 4));
  });
  for (const char* chain : {"diffuse:8:kappa=1", "diffuse:8:kappa=1:g=exp"}) {
    const DenseField before = reference::denseField(volume);
    const DenseField after = filteredOnGpu(volume, stepsOf(chain));
    const auto voxels = static_cast<double>(before.values.size());
    EXPECT_GT(differing(before, after), before.values.size() / 2);
    EXPECT_NEAR(sumOf(after) / voxels, sumOf(before) / voxels, 8 * 12 * 50 * kRounding);
  }
}

// With kappa huge diffusion is the heat equation: a cosine that is even about the border's faces stays one, and shrinks
// in each step by 1 - 4 dt/h^2 sin^2(k h / 2). Rounding: three operations of values below 1 a step, u each.
TEST(Diffusion, WithoutEdgesIsTheDiscreteHeatEquation) {
  constexpr int kSteps = 6;
  const Vec3 spacing_m = testLattice().spacing_m;
  const Vec3i size(24, 20, 28);
  for (int axis = 0; axis < 3; ++axis) {
    const double wave = std::numbers::pi * 3 / size[axis];  // phase between voxels: three half waves over the domain
    const auto cosine = [&](const Vec3i& voxel) { return std::cos(wave * (voxel[axis] + 0.5)); };
    const Volume volume = makeField(size, [&](int i, int j, int k) { return static_cast<float>(cosine({i, j, k})); });
    const DenseField after = filteredOnGpu(volume, stepsOf("diffuse:6:kappa=1e9:dt=0.1"));
    const double h_mm = spacing_m[axis] * 1e3;
    const double factor = 1 - 4 * 0.1 / (h_mm * h_mm) * std::pow(std::sin(wave / 2), 2);
    for (int c = 0; c < size[axis]; ++c) {
      const Vec3i voxel = Vec3i(5, 6, 7) + (c - Vec3i(5, 6, 7)[axis]) * Vec3i::Unit(axis);
      EXPECT_NEAR(after.at(voxel.x(), voxel.y(), voxel.z()), std::pow(factor, kSteps) * cosine(voxel),
                  (6 * kSteps + 1) * kRounding);
    }
  }
}

// A step of slope 400 kappa: at most the flow of one face, rate * d / (1 + s^2) < 1/2 * d / 160000 in each of ten
// steps. Ripples of slope far below kappa are smoothed as by heat: neighbours of opposite sign, at half of what is
// stable.
TEST(Diffusion, KeepsEdgesAndSmoothsRipples) {
  const Volume volume = makeField(
      {24, 12, 12}, [](int i, int j, int) { return (i < 12 ? 0.0F : 280.0F) + (j % 2 == 0 ? 0.01F : -0.01F); });
  const DenseField after = filteredOnGpu(volume, stepsOf("diffuse:10:kappa=1"));
  for (int i = 0; i < 24; ++i) {
    EXPECT_NEAR(after.at(i, 6, 6), i < 12 ? 0 : 280, 0.01 + 10 * 0.5 * 280 / 160000) << i;
  }
  EXPECT_LT(std::abs(after.at(2, 6, 6) - after.at(2, 5, 6)), 0.02 / 10);
}

// Up to the stable step a result is a mean of what was there: no new extremes, beyond the rounding of one step (four
// sums of values up to 1e3) each time.
TEST(Diffusion, MakesNoNewExtremes) {
  std::mt19937 random(5);
  const Volume volume = makeField({20, 17, 15}, [&](int, int, int) { return static_cast<float>(random() % 1000); });
  const std::string dt = std::to_string(std::floor(stableTimeStep(testLattice().spacing_m) * 1e6) / 1e6);
  for (const std::string g : {"rational", "exp"}) {
    const auto steps = stepsOf("diffuse:10:kappa=300:g=" + g + ":dt=" + dt);
    for (const float value : filteredOnGpu(volume, steps).values) {
      ASSERT_GE(value, -10 * 4 * 1000 * kRounding);
      ASSERT_LE(value, 999 + 10 * 4 * 1000 * kRounding);
    }
  }
}

}  // namespace filter_edge_test
}  // namespace palpate
