// SPDX-License-Identifier: Apache-2.0
// engine/reference/dense_field.hpp: a volume as one plain array, for the slow and obvious CPU twins. Any thread.
#pragma once

#include <cstddef>
#include <vector>

#include "base/lattice.hpp"
#include "engine/field/volume.hpp"

namespace palpate::reference {

struct DenseField {
  Vec3i size = Vec3i::Zero();  // [voxel]
  Lattice lattice;
  std::vector<float> values;  // i fastest

  [[nodiscard]] std::size_t offset(int i, int j, int k) const noexcept {
    return (static_cast<std::size_t>(k) * size.y() + j) * size.x() + i;
  }
  [[nodiscard]] float at(int i, int j, int k) const noexcept { return values[offset(i, j, k)]; }
};

[[nodiscard]] DenseField denseField(const Volume& volume);  // copies the whole domain

}  // namespace palpate::reference
