// SPDX-License-Identifier: Apache-2.0
#include "engine/field/raw_values.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

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

// Value `n` as a float.
template <class T>
class Conversion {
 public:
  Conversion(const char* raw, double slope, double intercept)
      : raw_(raw), slope_(slope), intercept_(intercept), scaled_(slope != 1 || intercept != 0) {}

  [[nodiscard]] float at(std::size_t n) const {
    T value = 0;
    std::memcpy(&value, raw_ + n * sizeof(T), sizeof(T));
    // Unscaled values keep their bits: -0 * 1 + 0 would be +0.
    const auto stored = static_cast<double>(value);
    if (scaled_) return floatOf(stored * slope_ + intercept_, std::is_integral_v<T> || std::isfinite(stored));
    return std::is_same_v<T, double> ? floatOf(stored) : static_cast<float>(value);
  }

  // Adds what is lost of the numbers from `first` on. x86's long double holds every 64-bit integer.
  void count(std::size_t first, std::size_t many, RoundedNumbers& rounded) const {
    if (scaled_ || sizeof(T) < 4 || std::is_same_v<T, float>) return;
    std::uint64_t found = 0;
    double most = 0;
    for (std::size_t n = first; n < first + many; ++n) {
      T value = 0;
      std::memcpy(&value, raw_ + n * sizeof(T), sizeof(T));
      const float kept = static_cast<float>(value);
      if (!std::isfinite(kept)) continue;  // finite_values.hpp tells of these
      const double change = static_cast<double>(std::abs(static_cast<long double>(value) - kept));
      found += change != 0 ? 1 : 0;
      most = std::max(most, change);
    }
    if (found == 0) return;
    rounded.count += found;
    for (double known = rounded.most; known < most && !rounded.most.compare_exchange_weak(known, most);) {
    }
  }

 private:
  const char* raw_;
  double slope_, intercept_;
  bool scaled_;
};

template <class T>
std::vector<float> convert(std::span<const char> raw, double slope, double intercept) {
  const Conversion<T> conversion(raw.data(), slope, intercept);
  std::vector<float> values(raw.size() / sizeof(T));
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = conversion.at(n);
  return values;
}

template <class T>
Volume::BrickSource bricks(const Conversion<T>& conversion, const Vec3i& size, RoundedNumbers* rounded) {
  return [conversion, size, rounded](const Vec3i& brick, float* values) {
    const Vec3i first = brick * kBrickSize;
    const Vec3i last = size - Vec3i::Ones();
    const bool whole_rows = first.x() + kBrickSize <= size.x();
    for (int k = 0; k < kBrickSize; ++k) {
      const auto z = static_cast<std::size_t>(std::min(first.z() + k, last.z()));
      for (int j = 0; j < kBrickSize; ++j) {
        const auto y = static_cast<std::size_t>(std::min(first.y() + j, last.y()));
        const std::size_t row = (z * static_cast<std::size_t>(size.y()) + y) * static_cast<std::size_t>(size.x());
        if (whole_rows) {
          const std::size_t from = row + static_cast<std::size_t>(first.x());
          for (std::size_t i = 0; i < kBrickSize; ++i) values[i] = conversion.at(from + i);
        } else {
          for (int i = 0; i < kBrickSize; ++i) {
            values[i] = conversion.at(row + static_cast<std::size_t>(std::min(first.x() + i, last.x())));
          }
        }
        values += kBrickSize;
        if (rounded == nullptr || first.y() + j > last.y() || first.z() + k > last.z()) continue;
        const int wide = std::min(kBrickSize, size.x() - first.x());
        conversion.count(row + static_cast<std::size_t>(first.x()), static_cast<std::size_t>(wide), *rounded);
      }
    }
    return false;
  };
}

}  // namespace

std::size_t byteSize(ValueType type) noexcept {
  return kTypes[static_cast<std::size_t>(type)].bytes;
}
std::string nameOf(ValueType type) {
  return kTypes[static_cast<std::size_t>(type)].name;
}

std::vector<float> toFloats(std::span<const char> raw, ValueType type, double slope, double intercept) {
  return withType(type, [&](auto number) { return convert<decltype(number)>(raw, slope, intercept); });
}

Volume::BrickSource rawBricks(std::span<const char> raw, ValueType type, const Vec3i& size, double slope,
                              double intercept, RoundedNumbers* rounded) {
  return withType(type, [&](auto number) {
    return bricks(Conversion<decltype(number)>(raw.data(), slope, intercept), size, rounded);
  });
}

std::string RoundedNumbers::words(ValueType type) const {
  if (count == 0) return "";
  return fmt::format("{} of its {} values are no 32-bit floats and were rounded, by {:.3g} at most", count.load(),
                     nameOf(type), most.load());
}

void swapBytes(std::span<char> raw, ValueType type) {
  withType(type, [&](auto number) {
    constexpr std::size_t kBytes = sizeof number;
    for (std::size_t at = 0; at + kBytes <= raw.size(); at += kBytes) {
      std::reverse(raw.data() + at, raw.data() + at + kBytes);
    }
  });
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
