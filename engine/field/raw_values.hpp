// SPDX-License-Identifier: Apache-2.0
// engine/field/raw_values.hpp: values as files hold them, made floats; and a lattice as files round it, made exact.
// Private to engine/field. Any thread.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/field/finite_values.hpp"
#include "engine/field/value_type.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Calls `work` with a number of the type.
template <class Work>
auto withType(ValueType type, const Work& work) {
  switch (type) {
    case ValueType::kUint8:
      return work(std::uint8_t{});
    case ValueType::kInt8:
      return work(std::int8_t{});
    case ValueType::kUint16:
      return work(std::uint16_t{});
    case ValueType::kInt16:
      return work(std::int16_t{});
    case ValueType::kUint32:
      return work(std::uint32_t{});
    case ValueType::kInt32:
      return work(std::int32_t{});
    case ValueType::kUint64:
      return work(std::uint64_t{});
    case ValueType::kInt64:
      return work(std::int64_t{});
    case ValueType::kFloat64:
      return work(double{});
    case ValueType::kFloat32:
      break;
  }
  return work(float{});
}

// A density, rounded once. Where `value` is finite and a float is not, the mark of that: a NaN with bits of its own,
// which engine/field/finite_values.hpp tells from what was NaN or infinite in the file. `finite`: whether what was
// stored, before it was scaled, is a number.
[[nodiscard]] inline float floatOf(double value, bool finite) {
  const auto density = static_cast<float>(value);
  return std::isinf(density) && finite ? beyondFloat() : density;
}
[[nodiscard]] inline float floatOf(double value) {
  return floatOf(value, std::isfinite(value));
}

// `raw` holds values of one type in the machine's byte order. Each becomes floatOf(value * slope + intercept).
[[nodiscard]] std::vector<float> toFloats(std::span<const char> raw, ValueType type, double slope = 1,
                                          double intercept = 0);

// The bricks of `raw`, which holds size.x * size.y * size.z such values, i fastest, and outlives the source; voxels
// outside the domain repeat the nearest one inside. May be called from several threads at once.
[[nodiscard]] Volume::BrickSource rawBricks(std::span<const char> raw, ValueType type, const Vec3i& size,
                                            double slope = 1, double intercept = 0);

// The other byte order, in place.
void swapBytes(std::span<char> raw, ValueType type);

// checkLattice, then the nearest true rotation or reflection, so that toIndex inverts toWorld to rounding.
[[nodiscard]] Lattice orthonormalised(Lattice lattice, const std::string& input);

}  // namespace palpate
