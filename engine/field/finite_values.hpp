// SPDX-License-Identifier: Apache-2.0
// engine/field/finite_values.hpp: file values that cannot be densities: NaN, infinite, or too large for a float. They
// are counted, and replaced by a density that the user chose. Private to engine/field.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <string>

#include "engine/field/volume.hpp"

namespace palpate {

// While a volume is read, this NaN marks a finite number that is too large for a float.
inline constexpr std::uint32_t kBeyondFloatBits = 0x7fd0'be10;
[[nodiscard]] inline float beyondFloat() noexcept {
  return std::bit_cast<float>(kBeyondFloatBits);
}

// How many voxels have no valid density.
struct BadVoxels {
  long long not_numbers = 0;   // NaN or infinite in the file
  long long beyond_float = 0;  // finite in the file, but too large for a float

  void add(float value) noexcept {
    ++(std::bit_cast<std::uint32_t>(value) == kBeyondFloatBits ? beyond_float : not_numbers);
  }
  void add(const BadVoxels& other) noexcept {
    not_numbers += other.not_numbers;
    beyond_float += other.beyond_float;
  }
  [[nodiscard]] long long count() const noexcept { return not_numbers + beyond_float; }
  [[nodiscard]] std::string words() const;  // for messages: "are NaN or infinite"
};

// Replaces invalid values while a volume is read, and counts them.
class FiniteValues {
 public:
  FiniteValues(const Vec3i& size, float instead) : size_(size), instead_(instead) {}

  // The same layers with invalid values replaced. Several threads may read them while this object lives.
  [[nodiscard]] Volume::LayerSource of(const Volume::LayerSource& layers);
  // To be called after all layers were read. Throws Error(kBadInput) if no voxel had a valid density.
  void check(const std::string& source) const;
  [[nodiscard]] std::string remark() const;  // how many were replaced, in words; "" if none
  [[nodiscard]] BadVoxels replaced() const { return {not_numbers_, beyond_float_}; }

 private:
  void mend(const Vec3i& brick, float* values);

  Vec3i size_;
  float instead_;
  std::atomic<long long> not_numbers_ = 0, beyond_float_ = 0;
};

}  // namespace palpate
