// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/seeded.hpp: random numbers for property tests, the same on every machine for a seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "base/lattice.hpp"

namespace palpate {

class Seeded {
 public:
  explicit Seeded(unsigned seed) : engine_(seed) {}

  double between(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  // Even in the logarithm: as often between 1 and 2 as between 10 and 20.
  double logBetween(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
  int pick(int count) { return static_cast<int>(between(0, count)); }  // 0 to count - 1
  Vec3 inCube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3 direction() {
    for (;;) {
      const Vec3 p = inCube(1);
      if (p.norm() > 0.1 && p.norm() < 1) return p.normalized();
    }
  }
  Vec3 across(const Vec3& normal) { return normal.cross(direction()).normalized(); }

  // A rotation; left-handed: with one column mirrored.
  Mat3 axes(bool left_handed) {
    Mat3 turned = Eigen::AngleAxisd(between(0, std::numbers::pi), direction()).toRotationMatrix();
    if (left_handed) turned.col(pick(3)) *= -1;
    return turned;
  }

 private:
  std::mt19937 engine_;  // the same numbers everywhere; those of std:: distributions differ by library
};

// Gaussian noise of variance 1. It is a function of seed and number, so that a sample always has the same noise.
inline double noiseAt(unsigned seed, std::uint64_t number) {
  std::uint64_t z = number + 0x9e3779b97f4a7c15U * (seed + 1ULL);  // splitmix64 (Steele, Lea, Flood 2014)
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  z ^= z >> 31U;
  const double u = (static_cast<double>(z >> 32U) + 1) / 4294967296.0;
  const double v = static_cast<double>(z & 0xffffffffU) / 4294967296.0;
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);  // Box and Muller 1958
}

}  // namespace palpate
