// SPDX-License-Identifier: Apache-2.0
#include "engine/field/finite_values.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {

std::string BadVoxels::words() const {
  if (beyond_float == 0) return "are NaN or infinite";
  const char* beyond = "beyond the range of a float, 3.4e38";
  if (not_numbers == 0) return fmt::format("are {}", beyond);
  return fmt::format("are no densities ({} NaN or infinite, {} {})", not_numbers, beyond_float, beyond);
}

Volume::LayerSource FiniteValues::of(const Volume::LayerSource& layers) {
  return [this, layers](int bk) -> Volume::BrickSource {
    return [this, bricks = layers(bk)](const Vec3i& brick, float* values) {
      const bool constant = bricks(brick, values);
      if (constant) std::fill(values + 1, values + kBrickVoxels, values[0]);
      const bool finite = std::all_of(values, values + kBrickVoxels, [](float value) { return std::isfinite(value); });
      if (finite) return constant;
      mend(brick, values);
      return false;
    };
  };
}

// Voxels outside the domain repeat voxels inside. They are replaced too, but not counted.
void FiniteValues::mend(const Vec3i& brick, float* values) {
  const Vec3i inside = (size_ - brick * kBrickSize).cwiseMin(kBrickSize);
  BadVoxels bad;
  for (int n = 0; n < kBrickVoxels; ++n) {
    if (std::isfinite(values[n])) continue;
    const Vec3i index(n % kBrickSize, n / kBrickSize % kBrickSize, n / (kBrickSize * kBrickSize));
    if ((index.array() < inside.array()).all()) bad.add(values[n]);
    values[n] = instead_;
  }
  not_numbers_ += bad.not_numbers;
  beyond_float_ += bad.beyond_float;
}

void FiniteValues::check(const std::string& source) const {
  const long long all = size_.cast<long long>().prod();
  if (replaced().count() < all) return;
  throw Error(Error::Code::kBadInput, source, fmt::format("all of its {} voxels {}", all, replaced().words()),
              "the file may be damaged: copy or write it again");
}

std::string FiniteValues::remark() const {
  if (replaced().count() == 0) return {};
  return fmt::format("{} of {} voxels {} in the file, and {} here", replaced().count(), size_.cast<long long>().prod(),
                     replaced().words(), instead_);
}

}  // namespace palpate
