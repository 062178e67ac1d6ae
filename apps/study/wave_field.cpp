// SPDX-License-Identifier: Apache-2.0
#include "apps/study/wave_field.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "apps/bench/random.hpp"

namespace palpate {
namespace {

constexpr double kLongestOverShortest = 2;
constexpr int kUniforms = 12;  // their sum less six has deviation 1 (Irwin and Hall)

double gauss(Random& random) {
  double sum = -0.5 * kUniforms;
  for (int i = 0; i < kUniforms; ++i) sum += random.uniform();
  return sum;
}

}  // namespace

WaveField::WaveField(std::uint64_t seed) {
  Random random(seed);
  for (Wave& wave : waves_) {
    const double length_m = kShortest_m * random.uniform(1, kLongestOverShortest);
    wave.k_per_m = 2 * std::numbers::pi / length_m * random.direction();
    wave.phase_rad = random.uniform(0, 2 * std::numbers::pi);
  }
  waves_[0].k_per_m *= 2 * std::numbers::pi / kShortest_m / waves_[0].k_per_m.norm();
}

double WaveField::density(const Vec3& p_W) const {
  double sum = 0;
  for (const Wave& wave : waves_) sum += kAmplitude * std::sin(wave.k_per_m.dot(p_W) + wave.phase_rad);
  return sum;
}

Vec3 WaveField::gradient(const Vec3& p_W) const {
  Vec3 sum = Vec3::Zero();
  for (const Wave& wave : waves_) {
    sum += kAmplitude * std::cos(wave.k_per_m.dot(p_W) + wave.phase_rad) * wave.k_per_m;
  }
  return sum;
}

double WaveField::usualGradient_per_m() const {
  double squares = 0;
  for (const Wave& wave : waves_) squares += 0.5 * kAmplitude * kAmplitude * wave.k_per_m.squaredNorm();
  return std::sqrt(squares);
}

Volume WaveField::volume(int edge, double noise, std::uint64_t seed) const {
  Lattice lattice;
  lattice.spacing_m = Vec3::Constant(spacing_m(edge));
  const double deviation = noise * kAmplitude * std::sqrt(0.5 * static_cast<double>(waves_.size()));
  Random random(seed);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(edge) * edge * edge);
  for (int k = 0; k < edge; ++k) {
    for (int j = 0; j < edge; ++j) {
      for (int i = 0; i < edge; ++i) {
        const double added = deviation > 0 ? deviation * gauss(random) : 0;
        values.push_back(static_cast<float>(density(lattice.toWorld(Vec3(i, j, k))) + added));
      }
    }
  }
  VolumeFacts facts;
  facts.source = fmt::format("waves in {0} x {0} x {0} voxels", edge);
  facts.declared_isovalue = 0;
  return Volume::fromDense(Vec3i::Constant(edge), lattice, values, std::move(facts));
}

}  // namespace palpate
