// SPDX-License-Identifier: Apache-2.0
// apps/bench/random.hpp: random numbers that are the same on every machine for the same seed. One thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "base/vec.hpp"

namespace palpate {

class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  // In [0, 1): the upper 53 bits of a 64-bit word. Distributions of the standard library differ between compilers.
  [[nodiscard]] double uniform() { return static_cast<double>(bits_() >> 11U) * 0x1p-53; }
  [[nodiscard]] double uniform(double low, double high) { return low + (high - low) * uniform(); }

  // Uniform on the unit sphere, whose height is uniform too (Archimedes).
  [[nodiscard]] Vec3 direction() {
    const double z = uniform(-1, 1);
    const double angle = uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace palpate
