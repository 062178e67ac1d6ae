// SPDX-License-Identifier: Apache-2.0
// Volumes that the pass tests share: sizes that are no multiple of the brick, spacing that differs by axis.
#pragma once

#include <string>
#include <vector>

#include "engine/volume/volume.hpp"

namespace palpate {

inline Lattice testLattice() {
  Lattice lattice;
  lattice.origin_W = {0.01, -0.02, 0.03};
  lattice.spacing_m = {0.7e-3, 0.9e-3, 1.3e-3};
  return lattice;
}

template <typename Density>
Volume makeField(const Vec3i& size, Density density) {
  std::vector<float> values;
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) values.push_back(density(i, j, k));
    }
  }
  return Volume::fromDense(size, testLattice(), values, {});
}

// Density falls with the distance [voxel] from the middle; far outside and inside it is constant, so some bricks are.
inline Volume ballField(const Vec3i& size, double radius_voxels) {
  const Vec3 middle = (size.cast<double>().array() - 1) / 2;
  return makeField(size, [=](int i, int j, int k) {
    const double inside = radius_voxels - (Vec3(i, j, k) - middle).norm();
    return static_cast<float>(std::clamp(inside, -3.0, 3.0));
  });
}

}  // namespace palpate
