// SPDX-License-Identifier: Apache-2.0
#include "apps/study/wave_field.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "apps/bench/random.hpp"

namespace palpate {
namespace wave_field_test {

Vec3 somewhere(Random& random) {
  return WaveField::kEdge_m * Vec3(random.uniform(), random.uniform(), random.uniform());
}

// Differences of fourth order over h = 0.1 mm: the next term is k^5 h^4 / 30 of each wave, below 4e-9 of its gradient
// for waves of 25 mm and more; rounding adds some 1e-13 / (k h) = 1e-11.
TEST(WaveField, ItsGradientIsThatOfItsDensity) {
  Random random(1);
  for (const std::uint64_t seed : {1U, 2U, 99U}) {
    const WaveField waves(seed);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p_W = somewhere(random);
      constexpr double kStep_m = 1e-4;
      Vec3 differences;
      for (int axis = 0; axis < 3; ++axis) {
        const auto at = [&](double steps) { return waves.density(p_W + steps * kStep_m * Vec3::Unit(axis)); };
        differences[axis] = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * kStep_m);
      }
      EXPECT_LE((differences - waves.gradient(p_W)).norm(), 1e-7 * waves.usualGradient_per_m());
    }
  }
}

// The mean over random places of a space much larger than the waves: relative error 1 / sqrt(20000), five times that.
TEST(WaveField, ItsUsualGradientIsTheRootMeanSquare) {
  const WaveField waves(3);
  Random random(2);
  double squares = 0;
  constexpr int kPlaces = 20000;
  for (int i = 0; i < kPlaces; ++i) {
    const Vec3 p_W(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9));
    squares += waves.gradient(p_W).squaredNorm() / kPlaces;
  }
  EXPECT_NEAR(std::sqrt(squares) / waves.usualGradient_per_m(), 1, 5 / std::sqrt(kPlaces));
}

// Densities are rounded to float once: half of 2^-24 of the largest, 6000.
TEST(WaveField, AVolumeHasItsDensities) {
  const WaveField waves(1);
  const Volume volume = waves.volume(20, 0, 1);
  EXPECT_EQ(volume.size(), Vec3i::Constant(20));
  EXPECT_DOUBLE_EQ(volume.lattice().spacing_m.x(), WaveField::kEdge_m / 20);
  for (int k = 0; k < 20; ++k) {
    const Vec3i voxel(k, 19 - k, (7 * k) % 20);
    const double exact = waves.density(volume.lattice().toWorld(voxel.cast<double>()));
    EXPECT_NEAR(volume.value(voxel), exact, 6000 * std::pow(2.0, -24));
  }
}

// A field of six waves of 1000 has the deviation 1000 sqrt(3). Over 40^3 voxels the deviation of the noise is known
// within 1 / sqrt(2 * 64000), its mean within 1 / sqrt(64000) of it; five times that.
TEST(WaveField, NoiseHasItsDeviation) {
  const WaveField waves(1);
  constexpr double kNoise = 0.1, kCount = 64000;
  const std::vector<float> clean = waves.volume(40, 0, 1).toDense(), noisy = waves.volume(40, kNoise, 1).toDense();
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < clean.size(); ++i) {
    const double off = static_cast<double>(noisy[i]) - static_cast<double>(clean[i]);
    sum += off;
    squares += off * off;
  }
  const double deviation = kNoise * 1000 * std::sqrt(3.0);
  EXPECT_NEAR(sum / kCount / deviation, 0, 5 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares / kCount) / deviation, 1, 5 / std::sqrt(2 * kCount));
  EXPECT_EQ(noisy, waves.volume(40, kNoise, 1).toDense());
  EXPECT_NE(noisy, waves.volume(40, kNoise, 2).toDense());
}

}  // namespace wave_field_test
}  // namespace palpate
