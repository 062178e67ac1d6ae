// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/raw_values.hpp"

#include <array>
#include <cstdint>
#include <cstring>

namespace palpate {
namespace {

struct TypeFacts {
  const char* name;
  std::size_t bytes;
};

constexpr std::array<TypeFacts, 10> kTypes = {{{"uint8", 1},
                                               {"int8", 1},
                                               {"uint16", 2},
                                               {"int16", 2},
                                               {"uint32", 4},
                                               {"int32", 4},
                                               {"uint64", 8},
                                               {"int64", 8},
                                               {"float32", 4},
                                               {"float64", 8}}};

template <class T>
std::vector<float> convert(const std::vector<char>& raw, double slope, double intercept) {
  const bool scaled = slope != 1 || intercept != 0;
  std::vector<float> values(raw.size() / sizeof(T));
  for (std::size_t n = 0; n < values.size(); ++n) {
    T value = 0;
    std::memcpy(&value, raw.data() + n * sizeof(T), sizeof(T));
    // Unscaled values keep their bits: -0 times 1 plus 0 would be +0.
    values[n] = scaled ? static_cast<float>(static_cast<double>(value) * slope + intercept) : static_cast<float>(value);
  }
  return values;
}

}  // namespace

std::size_t byteSize(ValueType type) noexcept {
  return kTypes[static_cast<std::size_t>(type)].bytes;
}
std::string nameOf(ValueType type) {
  return kTypes[static_cast<std::size_t>(type)].name;
}

std::vector<float> toFloats(const std::vector<char>& raw, ValueType type, double slope, double intercept) {
  switch (type) {
    case ValueType::kUint8:
      return convert<std::uint8_t>(raw, slope, intercept);
    case ValueType::kInt8:
      return convert<std::int8_t>(raw, slope, intercept);
    case ValueType::kUint16:
      return convert<std::uint16_t>(raw, slope, intercept);
    case ValueType::kInt16:
      return convert<std::int16_t>(raw, slope, intercept);
    case ValueType::kUint32:
      return convert<std::uint32_t>(raw, slope, intercept);
    case ValueType::kInt32:
      return convert<std::int32_t>(raw, slope, intercept);
    case ValueType::kUint64:
      return convert<std::uint64_t>(raw, slope, intercept);
    case ValueType::kInt64:
      return convert<std::int64_t>(raw, slope, intercept);
    case ValueType::kFloat32:
      return convert<float>(raw, slope, intercept);
    case ValueType::kFloat64:
      return convert<double>(raw, slope, intercept);
  }
  return {};
}

Lattice orthonormalised(Lattice lattice, const std::string& input) {
  checkLattice(lattice, input);
  // Newton's iteration for the polar factor; from 1e-4 it is exact after two steps.
  for (int step = 0; step < 3; ++step) {
    const Mat3 inverse_transposed = lattice.R_WL.inverse().transpose();
    lattice.R_WL = (lattice.R_WL + inverse_transposed) / 2;
  }
  return lattice;
}

}  // namespace palpate
