// SPDX-License-Identifier: Apache-2.0
// engine/field/finite_values.hpp: voxels that are no densities: what they are, and a number in their place. Private to
// engine/field.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <string>

#include "engine/field/volume.hpp"

namespace palpate {

// What stands for a number that a float cannot hold, while a volume is read: a NaN of no other meaning.
inline constexpr std::uint32_t kBeyondFloatBits = 0x7fd0'be10;
[[nodiscard]] inline float beyondFloat() noexcept {
  return std::bit_cast<float>(kBeyondFloatBits);
}

// How many voxels are no densities.
struct BadVoxels {
  long long not_numbers = 0;   // NaN or infinite in the file
  long long beyond_float = 0;  // numbers there, and beyond the range of a float

  void add(float value) noexcept {
    ++(std::bit_cast<std::uint32_t>(value) == kBeyondFloatBits ? beyond_float : not_numbers);
  }
  void add(const BadVoxels& other) noexcept {
    not_numbers += other.not_numbers;
    beyond_float += other.beyond_float;
  }
  [[nodiscard]] long long count() const noexcept { return not_numbers + beyond_float; }
  [[nodiscard]] std::string words() const;  // what they are: "are NaN or infinite"
};

class FiniteValues {
 public:
  FiniteValues(const Vec3i& size, float instead) : size_(size), instead_(instead) {}

  // The same layers with such voxels replaced. They may be asked for by several threads, while this lives.
  [[nodiscard]] Volume::LayerSource of(const Volume::LayerSource& layers);
  // After all of them: throws Error(kBadInput) if no voxel was a density.
  void check(const std::string& source) const;
  [[nodiscard]] std::string remark() const;  // how many; "" where there was none

 private:
  void mend(const Vec3i& brick, float* values);
  [[nodiscard]] BadVoxels replaced() const { return {not_numbers_, beyond_float_}; }

  Vec3i size_;
  float instead_;
  std::atomic<long long> not_numbers_ = 0, beyond_float_ = 0;
};

}  // namespace palpate
