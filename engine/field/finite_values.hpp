// SPDX-License-Identifier: Apache-2.0
// engine/field/finite_values.hpp: puts a number in place of voxels that are NaN or infinite, and counts them. Private
// to engine/field.
#pragma once

#include <atomic>
#include <string>

#include "engine/field/volume.hpp"

namespace palpate {

class FiniteValues {
 public:
  FiniteValues(const Vec3i& size, float instead) : size_(size), instead_(instead) {}

  // The same layers with such voxels replaced. They may be asked for by several threads, while this lives.
  [[nodiscard]] Volume::LayerSource of(const Volume::LayerSource& layers);
  // After all of them: throws Error(kBadInput) if no voxel was a number.
  void check(const std::string& source) const;
  [[nodiscard]] std::string remark() const;  // how many; "" where there was none

 private:
  void mend(const Vec3i& brick, float* values);

  Vec3i size_;
  float instead_;
  std::atomic<long long> replaced_ = 0;
};

}  // namespace palpate
