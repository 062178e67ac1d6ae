// SPDX-License-Identifier: Apache-2.0
// engine/volume/raw_values.hpp: values as files hold them, made floats; and a lattice as files round it, made exact.
// Private to engine/volume. Any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/volume/value_type.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

// `raw` holds values of one type in the machine's byte order. Each becomes float(value * slope + intercept), rounded
// once.
[[nodiscard]] std::vector<float> toFloats(const std::vector<char>& raw, ValueType type, double slope = 1,
                                          double intercept = 0);

// The bricks of `raw`, which holds size.x * size.y * size.z such values, i fastest, and outlives the source; voxels
// outside the domain repeat the nearest one inside. May be called from several threads at once.
[[nodiscard]] Volume::BrickSource rawBricks(std::span<const char> raw, ValueType type, const Vec3i& size,
                                            double slope = 1, double intercept = 0);

// checkLattice, then the nearest true rotation or reflection, so that toIndex inverts toWorld to rounding.
[[nodiscard]] Lattice orthonormalised(Lattice lattice, const std::string& input);

}  // namespace palpate
