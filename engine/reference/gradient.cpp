// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/gradient.hpp"

namespace palpate::reference {

DifferenceScale differenceScale(const Vec3& spacing_m) {
  DifferenceScale scale{};
  for (int axis = 0; axis < 3; ++axis) {
    scale.inv_2h_per_m[axis] = static_cast<float>(1.0 / (2.0 * spacing_m[axis]));
    scale.inv_h_per_m[axis] = static_cast<float>(1.0 / spacing_m[axis]);
  }
  return scale;
}

std::array<float, 3> gradientAt(const DenseField& field, int i, int j, int k) {
  const DifferenceScale scale = differenceScale(field.lattice.spacing_m);
  const std::array<int, 3> voxel = {i, j, k};
  std::array<float, 3> gradient{};
  for (int axis = 0; axis < 3; ++axis) {
    std::array<int, 3> before = voxel;
    std::array<int, 3> after = voxel;
    const bool at_low = voxel[axis] == 0;
    const bool at_high = voxel[axis] == field.size[axis] - 1;
    if (!at_low) --before[axis];
    if (!at_high) ++after[axis];
    const float difference = field.at(after[0], after[1], after[2]) - field.at(before[0], before[1], before[2]);
    gradient[axis] = difference * (at_low || at_high ? scale.inv_h_per_m[axis] : scale.inv_2h_per_m[axis]);
  }
  return gradient;
}

}  // namespace palpate::reference
