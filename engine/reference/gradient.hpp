// SPDX-License-Identifier: Apache-2.0
// engine/reference/gradient.hpp: the CPU twin of shaders/gradient.comp. Any thread; one pass over the volume.
#pragma once

#include <array>

#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Gradient at a voxel along the lattice's axes [density/m]: (f(+1) - f(-1)) * (1 / 2h), at the border (f(+1) - f(0)) *
// (1/h) or (f(0) - f(-1)) * (1/h). All in float, no contraction: lavapipe must agree bit for bit.
[[nodiscard]] std::array<float, 3> gradientAt(const DenseField& field, int i, int j, int k);

// The factors 1/(2h) and 1/h, rounded to float once: kernel and twin are handed the same numbers.
struct DifferenceScale {
  std::array<float, 3> inv_2h_per_m;
  std::array<float, 3> inv_h_per_m;
};
[[nodiscard]] DifferenceScale differenceScale(const Vec3& spacing_m);

}  // namespace palpate::reference
