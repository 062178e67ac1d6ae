// SPDX-License-Identifier: Apache-2.0
// The Gaussian against formulas: what it does to an impulse, a wave and a mean. The kernels agree with this twin bit
// for bit (tests/engine/filter_passes/filter_test.cpp), so what holds here holds there.
#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "engine/reference/filter.hpp"

namespace palpate {
namespace gaussian_test {

constexpr double kUlp = 0x1p-24;  // half the distance of floats at 1: what one rounding may add, relative

template <typename Density>
reference::DenseField fieldOf(const Vec3i& size, const Vec3& spacing_m, Density density) {
  reference::DenseField field{size, {}, {}};
  field.lattice.spacing_m = spacing_m;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) field.values.push_back(static_cast<float>(density(i, j, k)));
    }
  }
  return field;
}

reference::DenseField filtered(const reference::DenseField& field, const char* chain) {
  return reference::applyFilters(field, lowerFilters(filterChain(chain), field.lattice.spacing_m));
}

// The impulse's response is the kernel: exp(-x^2 / 2 sigma^2) in millimetres along every axis of an anisotropic
// lattice. Each of three taps is rounded once and multiplied twice: five roundings.
TEST(Gaussian, RespondsToAnImpulseWithAGaussian) {
  const Vec3 spacing_m(0.5e-3, 1e-3, 2e-3);
  const double sigma_m = 1.2e-3;
  const auto after =
      filtered(fieldOf({31, 17, 11}, spacing_m, [](int i, int j, int k) { return i == 15 && j == 8 && k == 5; }),
               "gaussian:1.2mm:truncate=4");
  const float middle = after.at(15, 8, 5);
  for (const Vec3i& d :
       {Vec3i(1, 0, 0), Vec3i(0, 1, 0), Vec3i(0, 0, 1), Vec3i(-3, 2, 1), Vec3i(5, -3, 2), Vec3i(-9, -4, -2)}) {
    const double r2 = d.cast<double>().cwiseProduct(spacing_m).squaredNorm();
    const double expected = std::exp(-r2 / (2 * sigma_m * sigma_m));
    EXPECT_NEAR(after.at(15 + d.x(), 8 + d.y(), 5 + d.z()) / middle, expected, expected * 11 * kUlp) << d.transpose();
  }
  EXPECT_EQ(after.at(15 + 11, 8, 5), 0.0F);  // four sigmas are ten voxels along i
}

// A wave keeps its shape; a sampled Gaussian takes exp(-(k sigma)^2 / 2) of it, but for the tails cut off at 4 sigma
// (erfc(4/sqrt 2) = 6.3e-5 of the weight, twice: in the response and in the norm) and aliasing (exp(-(2 pi - k)^2
// sigma^2 / 2), below 1e-9 here).
TEST(Gaussian, DampsAWaveAsItsTransformSays) {
  const double sigma = 1.5;
  for (const double k : {0.1, 0.4, 0.8, 1.2}) {
    const auto after =
        filtered(fieldOf({96, 3, 3}, Vec3::Ones(), [&](int i, int, int) { return std::cos(k * (i - 48)); }),
                 "gaussian:1.5:truncate=4");
    EXPECT_NEAR(after.at(48, 1, 1), std::exp(-k * k * sigma * sigma / 2), 2 * 6.4e-5) << k;
    EXPECT_NEAR(after.at(48 + 7, 1, 1) - after.at(48, 1, 1) * std::cos(7 * k), 0, 40 * kUlp) << k;
  }
}

// Mirrored at the border every density gives away all of its weight inside, so the mean stays. Three passes of seven
// taps: 3 * (7 products, 6 sums, the taps' rounding) of at most 100 each, averaged.
TEST(Gaussian, KeepsTheMeanWhereTheBorderMirrors) {
  const auto before =
      fieldOf({13, 9, 7}, Vec3::Ones(), [](int i, int j, int k) { return (i * 37 + j * 101 + k * 59) % 201 - 100; });
  const auto after = filtered(before, "gaussian:0.9:border=mirror");
  const auto mean = [](const reference::DenseField& field) {
    return std::accumulate(field.values.begin(), field.values.end(), 0.0) / static_cast<double>(field.values.size());
  };
  EXPECT_NEAR(mean(after), mean(before), 3 * 20 * 100 * kUlp);
  EXPECT_GT(std::abs(mean(filtered(before, "gaussian:0.9")) - mean(before)), 1e-3);  // nearest does not promise it
}

// After each slice of each round: one round a step, six for a distance, of whose five steps the voxels across are
// besides.
TEST(Progress, OfFiltersGrowsToOneBySlices) {
  const auto field = fieldOf({6, 5, 3}, Vec3::Ones(), [](int i, int, int) { return i - 2.5; });
  const auto told = [&](const char* chain) {
    std::vector<double> all;
    static_cast<void>(reference::applyFilters(field, lowerFilters(filterChain(chain), Vec3::Ones(), 0.0F),
                                              [&](double done) { all.push_back(done); }));
    return all;
  };
  const auto expectEqual = [](const std::vector<double>& got, const std::vector<double>& want) {
    ASSERT_EQ(got.size(), want.size());
    for (std::size_t n = 0; n < got.size(); ++n) EXPECT_NEAR(got[n], want[n], 1e-14) << n;
  };
  std::vector<double> three;
  for (int n = 1; n <= 9; ++n) three.push_back(n / 9.0);
  expectEqual(told("gaussian:1"), three);
  std::vector<double> both;  // of a median and a distance: six steps
  for (int n = 1; n <= 3; ++n) both.push_back(n / 3.0 / 6);
  for (int n = 1; n <= 18; ++n) both.push_back((1 + 5 * n / 18.0) / 6);
  expectEqual(told("median:1 distance:1"), both);
}

// Variances add up: sigma 1.2 after 0.9 is sigma 1.5, to what is cut off beyond 5 sigma (6e-7 of the weight each).
TEST(Gaussian, TwoMakeALargerOne) {
  const auto wave =
      fieldOf({80, 3, 3}, Vec3::Ones(), [](int i, int, int) { return std::sin(0.3 * i) + 0.5 * std::cos(0.7 * i); });
  const auto two = filtered(wave, "gaussian:1.2:truncate=5 gaussian:0.9:truncate=5");
  const auto one = filtered(wave, "gaussian:1.5:truncate=5");
  // Sampling: the response of sigma 0.9 at k = 0.7 differs from the transform by exp(-(2 pi - 0.7)^2 0.81 / 2)
  // = 3.3e-6.
  for (int i = 25; i < 55; ++i) EXPECT_NEAR(two.at(i, 1, 1), one.at(i, 1, 1), 1e-5) << i;
}

}  // namespace gaussian_test
}  // namespace palpate
