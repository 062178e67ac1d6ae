// SPDX-License-Identifier: Apache-2.0
// engine/field/raw_values.hpp: turns what files hold into what volumes hold: numbers of any type into floats, and a
// lattice that the file rounded into an exact one. For engine/field and engine/files. Any thread.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/field/finite_values.hpp"
#include "engine/field/value_type.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Calls `work` with a zero of the C++ type that `type` stands for.
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

// Rounds a density to float. A value that is too large for a float becomes beyondFloat(), which finite_values.hpp tells
// from a NaN in the file. `finite`: whether the stored number, before it was scaled, was finite.
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

// What rounding changed among a few numbers.
struct RoundedFew {
  std::uint64_t count = 0;
  double most = 0;  // [density]

  // `exact` became `kept`. NaN, what is infinite and what became beyondFloat() differ from themselves by NaN, which is
  // not above 0: finite_values.hpp tells of these.
  template <class Number>
  void add(Number exact, float kept) noexcept {
    const auto change = static_cast<double>(std::abs(exact - static_cast<Number>(kept)));
    count += change > 0 ? 1 : 0;
    most = change > most ? change : most;
  }
};

// The same of a whole volume. Several threads may add at once.
class RoundedNumbers {
 public:
  void add(const RoundedFew& few) noexcept;
  // `type`: of the file's numbers; `scaled`: whether the file scales them.
  [[nodiscard]] Rounding of(const std::string& type, bool scaled) const;

 private:
  std::atomic<std::uint64_t> count_ = 0;
  std::atomic<double> most_ = 0;
};

// The bricks of size.x * size.y * size.z such values, i fastest. `raw` must outlive the source. Voxels outside the
// domain repeat the nearest one inside. Several threads may call the source at once. `rounded`, if given, must outlive
// it.
// Cost: to read numbers from a file in memory into a volume takes 2.5 ns (int32) to 3.3 ns (double) each. To count adds
// nothing where floats hold every number of the type; 0.2 ns for integers of 32 or 64 bits all below 2^24; 0.5 ns for
// doubles; 0.8 ns for other int32; 0.9 ns for scaled numbers; 2.5 ns for other int64. (Processor time, medians of 15
// interleaved pairs, 160^3.)
[[nodiscard]] Volume::BrickSource rawBricks(std::span<const char> raw, ValueType type, const Vec3i& size,
                                            double slope = 1, double intercept = 0, RoundedNumbers* rounded = nullptr);

// Reverses the byte order of each value, in place.
void swapBytes(std::span<char> raw, ValueType type);

// Checks the lattice (checkLattice), then replaces its axes by the nearest orthonormal ones. So toIndex inverts toWorld
// to rounding. `input`: for messages.
[[nodiscard]] Lattice orthonormalised(Lattice lattice, const std::string& input);

}  // namespace palpate
