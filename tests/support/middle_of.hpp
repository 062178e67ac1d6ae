// SPDX-License-Identifier: Apache-2.0
// tests/support/middle_of.hpp: a part of a volume that is too large for a test.
#pragma once

#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

// Of a volume its middle, no side longer than `most`, where it lies in the world: the farther from the world's origin,
// the coarser are floats.
inline Volume middleOf(const Volume& volume, int most) {
  const Vec3i size = volume.size().cwiseMin(most);
  const Vec3i first = (volume.size() - size) / 2;
  std::vector<float> values;
  for (int n = 0; n < size.prod(); ++n)
    values.push_back(volume.value(first + Vec3i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y())));
  return Volume::fromDense(size, volume.lattice().shifted(first), values, {});
}

}  // namespace palpate
