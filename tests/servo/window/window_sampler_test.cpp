// SPDX-License-Identifier: Apache-2.0
#include "servo/window/window_sampler.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "support/analytic_volume.hpp"

namespace palpate {
namespace window_sampler_test {

// Turned, mirrored and with voxels of three sizes, so that no axis can stand for another.
Lattice turnedLattice() {
  Lattice lattice;
  lattice.origin_W = Vec3(0.1, -0.2, 0.05);
  lattice.R_WL = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  lattice.R_WL.col(0) *= -1;
  lattice.spacing_m = Vec3(0.5e-3, 1e-3, 2e-3);
  return lattice;
}

Vec3 randomIndex(std::mt19937& random, const Vec3i& size) {
  std::uniform_real_distribution<double> unit(0, 1);
  return Vec3(unit(random), unit(random), unit(random)).cwiseProduct((size - Vec3i::Ones()).cast<double>());
}

// A linear field is reproduced by trilinear interpolation; what is left is float rounding: values up to |f| = 1 in
// seven lerps, 10 roundings of 6e-8 each at the most; gradients up to 30 likewise.
TEST(Fetch, LinearFieldInATurnedAnisotropicWindow) {
  const Vec3 slope_per_m(3, -20, 11);
  AnalyticVolume volume{turnedLattice(), Vec3i(9, 14, 11), {}};
  volume.density = [&](const Vec3& p_W) { return 0.25 + slope_per_m.dot(p_W - volume.lattice.origin_W); };
  HeldWindow held;
  volume.hold(held, Vec3i(1, 2, 3), Vec3i(7, 10, 6));
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p_W = held.window.lattice.toWorld(randomIndex(random, held.window.size));
    const Fetch f = fetch(held.window, p_W);
    ASSERT_EQ(f.place, Place::kInside);
    ASSERT_NEAR(f.density, volume.density(p_W), 1e-6);
    // The samples' own gradients are differences of doubles, rounded once; turned by R_WL.
    ASSERT_LT((f.gradient_W - slope_per_m).norm(), 30 * 10 * 6e-8);
  }
}

// Against the definition, summed over eight corners in double; random samples, so every corner counts.
TEST(Fetch, TrilinearFormulaOnRandomSamples) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> value(-1, 1);
  HeldWindow held;
  held.window.size = Vec3i(5, 6, 7);
  held.window.lattice = turnedLattice();
  held.window.version = 1;
  for (int i = 0; i < 5 * 6 * 7; ++i)
    held.samples.push_back({value(random), value(random), value(random), value(random)});
  held.window.samples = held.samples.data();
  for (int n = 0; n < 2000; ++n) {
    const Vec3 p_L = randomIndex(random, held.window.size);
    const Vec3i low = p_L.array().floor().cast<int>();
    const Vec3 t = p_L - low.cast<double>();
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i bit(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
      const Vec3i at = (low + bit).cwiseMin(held.window.size - Vec3i::Ones());
      const double weight =
          (bit.x() ? t.x() : 1 - t.x()) * (bit.y() ? t.y() : 1 - t.y()) * (bit.z() ? t.z() : 1 - t.z());
      const Sample& s = held.samples[static_cast<std::size_t>(at.x() + 5 * (at.y() + 6 * at.z()))];
      sum += weight * Eigen::Vector4d(s.gradient_i, s.gradient_j, s.gradient_k, s.density);
    }
    const Fetch f = fetch(held.window, held.window.lattice.toWorld(p_L));
    ASSERT_NEAR(f.density, sum[3], 2e-6);
    ASSERT_LT((f.gradient_W - held.window.lattice.R_WL * sum.head<3>()).norm(), 4e-6);
  }
}

TEST(Fetch, SamplesAreMetExactlyUpToTheLast) {
  AnalyticVolume volume =
      millimetreVolume([](const Vec3& p_W) { return std::sin(400 * p_W.x()) * p_W.y() - p_W.z(); }, 8);
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(8));
  for (int i = 0; i < 512; ++i) {
    const Vec3i at(i % 8, i / 8 % 8, i / 64);
    const Fetch f = fetch(held.window, volume.lattice.toWorld(at.cast<double>()));
    ASSERT_EQ(f.place, Place::kInside);
    // The position may be a rounding off the sample: 1e-15 of a voxel.
    ASSERT_NEAR(f.density, static_cast<float>(volume.sample(at)), 1e-9);
  }
}

TEST(Fetch, AConstantFieldComesBackExactly) {
  AnalyticVolume volume = millimetreVolume([](const Vec3&) { return 300.1f; }, 8);
  HeldWindow held;
  volume.hold(held, Vec3i::Zero(), Vec3i::Constant(8));
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_EQ(fetch(held.window, volume.lattice.toWorld(randomIndex(random, volume.size))).density, 300.1f);
  }
}

// Low faces are the volume's along x, high ones along y; along z the window just ends.
TEST(Fetch, BeyondTheVolumeOrBeyondTheWindow) {
  HeldWindow held;
  millimetreVolume([](const Vec3&) { return 1.0; }, 8).hold(held, Vec3i::Zero(), Vec3i::Constant(4));
  held.window.low_is_border = {true, false, false};
  held.window.high_is_border = {false, true, false};
  const auto at = [&](double x, double y, double z) { return fetch(held.window, Vec3(x, y, z) * 1e-3); };
  EXPECT_EQ(at(-0.5, 1, 1).place, Place::kBeyondVolume);
  EXPECT_EQ(at(-0.5, 1, 1).density, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(at(-0.5, 1, 1).gradient_W.isZero(0));
  EXPECT_EQ(at(1, 3.5, 1).place, Place::kBeyondVolume);
  EXPECT_EQ(at(-0.5, 3.5, 1).place, Place::kBeyondVolume);
  EXPECT_EQ(at(3.5, 1, 1).place, Place::kBeyondWindow);
  EXPECT_EQ(at(1, -0.5, 1).place, Place::kBeyondWindow);
  EXPECT_EQ(at(1, 1, 3.5).place, Place::kBeyondWindow);
  EXPECT_EQ(at(-0.5, 1, -0.5).place, Place::kBeyondWindow);  // one border, one that is none
  EXPECT_EQ(at(NAN, 1, 1).place, Place::kBeyondWindow);
  EXPECT_EQ(at(-INFINITY, 1, 1).place, Place::kBeyondWindow);
  held.window.version = 0;
  EXPECT_EQ(at(1, 1, 1).place, Place::kBeyondWindow);
  held.window.low_is_border = held.window.high_is_border = {true, true, true};
  EXPECT_EQ(at(1, 1, 1).place, Place::kBeyondWindow);
}

}  // namespace window_sampler_test
}  // namespace palpate
