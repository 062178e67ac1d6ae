// SPDX-License-Identifier: Apache-2.0
// Gradient operators on plane waves, whose response is known exactly: the order of each, and its error.
#include "engine/reference/gradient.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/filter/filter_step.hpp"

namespace palpate {
namespace gradient_test {

// The wave sin(k.x + 0.3) with k in 1/m, on voxels that differ by axis, `times` as fine as the coarsest: its phase
// advances by 0.8, 0.744 and 0.72 a voxel there.
const Vec3 kWave(800, 620, 480);
const Vec3 kCoarse_m(1.0e-3, 1.2e-3, 1.5e-3);

reference::DenseField wave(int times, const Vec3i& size) {
  reference::DenseField field;
  field.size = size;
  field.lattice.spacing_m = kCoarse_m / times;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i)
        field.values.push_back(
            static_cast<float>(std::sin(kWave.dot(Vec3(i, j, k).cwiseProduct(field.lattice.spacing_m)) + 0.3)));
    }
  }
  return field;
}

double sinc(double w) {
  return std::sin(w) / w;
}

// What an operator makes of the derivative of a wave along an axis; w: the wave's phase from voxel to voxel, by axis.
// A plane wave is an eigenfunction of every convolution, so this is exact.
double response(std::string_view name, const Vec3& w, int axis, const std::vector<FilterStep>& steps) {
  if (name == "central4") return (8 * std::sin(w[axis]) - std::sin(2 * w[axis])) / (6 * w[axis]);
  double factor = sinc(w[axis]);
  for (int other = 0; name == "sobel" && other < 3; ++other) {
    if (other != axis) factor *= std::pow(std::cos(w[other] / 2), 2);
  }
  for (const FilterStep& step : steps) {
    double sum = static_cast<double>(step.taps[0]);
    for (std::size_t n = 1; n < step.taps.size(); ++n)
      sum += 2 * static_cast<double>(step.taps[n]) * std::cos(static_cast<double>(n) * w[step.axis]);
    factor *= sum;
  }
  return factor;
}

// A gradient at voxels inside is the response times the derivative. Densities are rounded by 2^-24 of at most 1; so is
// every operation, of at most 2 (of Sobel's 16 weights, which are divided out): some 20 roundings for a stencil, and
// over a Gaussian's reach of 12 another 25 products and 24 sums an axis, whose taps are rounded too. All over the
// spacing.
double roundingError(const GradientOperator& gradient_operator) {
  return (gradient_operator.smooths() ? 20 + 3 * 3 * 25 : 20) * std::ldexp(1.0, -24);
}

TEST(GradientOperators, RespondToAWaveAsDerived) {
  for (const char* name : {"central", "sobel", "central4", "gaussian:2mm"}) {
    const GradientOperator gradient_operator = gradientOperator(name);
    const reference::DenseField field = wave(2, {31, 29, 27});
    const reference::DenseField smoothed = reference::smoothedFor(gradient_operator, field);
    const std::vector<FilterStep> steps = lowerFilters(gradient_operator.smoothing, field.lattice.spacing_m);
    const Vec3 w = kWave.cwiseProduct(field.lattice.spacing_m);
    ASSERT_LE(totalReach(steps).maxCoeff(), 12);
    for (const Vec3i& p : {Vec3i(15, 14, 13), Vec3i(13, 15, 12), Vec3i(16, 13, 14)}) {
      const auto got = reference::gradientAt(smoothed, gradient_operator, p.x(), p.y(), p.z());
      for (int axis = 0; axis < 3; ++axis) {
        const double phase = kWave.dot(p.cast<double>().cwiseProduct(field.lattice.spacing_m)) + 0.3;
        const double want = response(gradient_operator.kind.name, w, axis, steps) * kWave[axis] * std::cos(phase);
        EXPECT_NEAR(static_cast<double>(got[static_cast<std::size_t>(axis)]), want,
                    roundingError(gradient_operator) / field.lattice.spacing_m[axis])
            << name << " axis " << axis;
      }
    }
  }
}

// A largest error over some points of the world, relative to the wave's number; `exact`: of the derivative, what the
// operator converges to.
double largestError(const GradientOperator& gradient_operator, int times, double exact) {
  constexpr int kFirst = 8;  // coarse voxels from the border, more than the Gaussian reaches
  const reference::DenseField field = wave(times, Vec3i::Constant((2 * kFirst + 3) * times));
  const reference::DenseField smoothed = reference::smoothedFor(gradient_operator, field);
  double worst = 0;
  for (int n = 0; n < 9; ++n) {
    const Vec3i p = times * (Vec3i::Constant(kFirst) + Vec3i(n % 3, n / 3, (n * 2) % 3));
    const auto got = reference::gradientAt(smoothed, gradient_operator, p.x(), p.y(), p.z());
    const double phase = kWave.dot(p.cast<double>().cwiseProduct(field.lattice.spacing_m)) + 0.3;
    const double want = exact * kWave.x() * std::cos(phase);
    worst = std::max(worst, std::abs(static_cast<double>(got[0]) - want) / kWave.x());
  }
  return worst;
}

// Halving h divides the error by 2^p, but for the next term of the series in the phase w of a voxel: with
// e = a w^p (1 - b w^2 ...) the order that is seen is p - b w^2 (1 - 1/4) / ln 2. From the series of the responses
//   central, and the Gaussian, whose own response at fixed sigma is what it converges to: b = 1/20
//   sobel     1 - sinc(w) cos^2(w/2) cos^2(w/2) = 2/3 w^2 (1 - 0.29 w^2 ...): b = 0.29
//   central4  w^4 / 30 - w^6 / 252: b = 30 / 252
// A fifth of that is left for the terms after it, and the rounding error of the finer one is counted twice. The sampled
// Gaussian's sum differs from its integral by exp(-2 (pi sigma)^2) at sigma 1.33 voxels and more: less than 1e-15; cut
// at six sigmas, by 2e-9.
TEST(GradientOperators, ConvergeWithTheirOrder) {
  struct Case {
    const char* name;
    int times;  // of the coarser of the two
    double order, b;
  };
  for (const Case& c : {Case{"central", 2, 2, 0.05}, Case{"sobel", 2, 2, 0.29}, Case{"central4", 1, 4, 30.0 / 252},
                        Case{"gaussian:1mm:truncate=6", 2, 2, 0.05}}) {
    const GradientOperator gradient_operator = gradientOperator(c.name);
    const double sigma_m = gradient_operator.smooths() ? gradient_operator.smoothing[0].size.value : 0;
    const double exact = std::exp(-0.5 * sigma_m * sigma_m * kWave.squaredNorm());
    const double coarse = largestError(gradient_operator, c.times, exact);
    const double fine = largestError(gradient_operator, 2 * c.times, exact);
    const double w = kWave.x() * kCoarse_m.x() / c.times;
    const double series = c.b * w * w * 0.75 / std::numbers::ln2;
    const double rounding = 2 * roundingError(gradient_operator) / (w / 2) / fine / std::numbers::ln2;
    ASSERT_LT(rounding, 0.1) << c.name;
    EXPECT_NEAR(std::log2(coarse / fine), c.order - series, 0.2 * series + rounding) << c.name;
  }
}

}  // namespace gradient_test
}  // namespace palpate
