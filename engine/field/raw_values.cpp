// SPDX-License-Identifier: Apache-2.0
#include "engine/field/raw_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

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

// Whether the magnitudes of kBrickVoxels floats all are below `limit`. NaN has none.
bool allBelow(const float* values, float limit) {
  using Floats [[gnu::vector_size(4 * sizeof(float))]] = float;
  using Bits [[gnu::vector_size(4 * sizeof(float))]] = std::int32_t;
  Bits below = {-1, -1, -1, -1};
  for (int n = 0; n < kBrickVoxels; n += 4) {
    Floats four;
    std::memcpy(&four, values + n, sizeof four);
    below &= (four < limit) & (four > -limit);
  }
  return (below[0] & below[1] & below[2] & below[3]) != 0;
}

// RoundedFew of many numbers. They are converted four at once and compared two at once, as every processor can, with
// sums of their own for each pair of four, so that no instruction waits for the one before it.
class RoundedMany {
 public:
  RoundedMany(double slope, double intercept) : slope_{slope, slope}, intercept_{intercept, intercept} {}

  // T that `raw` holds, and what they became.
  template <class T>
  void addFour(const char* raw, const float* kept) {
    using Four [[gnu::vector_size(4 * sizeof(T))]] = T;
    using Floats [[gnu::vector_size(4 * sizeof(float))]] = float;
    using Wide [[gnu::vector_size(4 * sizeof(double))]] = double;
    Four numbers;
    Floats floats;
    std::memcpy(&numbers, raw, sizeof numbers);
    std::memcpy(&floats, kept, sizeof floats);
    const Wide stored = __builtin_convertvector(numbers, Wide), become = __builtin_convertvector(floats, Wide);
    add(low_, __builtin_shufflevector(stored, stored, 0, 1), __builtin_shufflevector(become, become, 0, 1));
    add(high_, __builtin_shufflevector(stored, stored, 2, 3), __builtin_shufflevector(become, become, 2, 3));
  }

  // Lanes are named one by one: an index that is no constant would keep the sums in memory.
  [[nodiscard]] RoundedFew all() const {
    const Counts counts = low_.counts + high_.counts;
    const Doubles most = low_.most > high_.most ? low_.most : high_.most;
    return {static_cast<std::uint64_t>(counts[0] + counts[1]), std::max(most[0], most[1])};
  }

 private:
  using Doubles [[gnu::vector_size(2 * sizeof(double))]] = double;
  using Counts [[gnu::vector_size(2 * sizeof(double))]] = std::int64_t;
  struct Pair {
    Counts counts = {};
    Doubles most = {};
  };

  void add(Pair& pair, Doubles stored, Doubles kept) const {
    constexpr std::int64_t kWithoutSign = std::numeric_limits<std::int64_t>::max();
    const Doubles difference = stored * slope_ + intercept_ - kept;
    const auto change = std::bit_cast<Doubles>(std::bit_cast<Counts>(difference) & kWithoutSign);
    pair.counts -= change > 0;  // which is -1 where it holds
    pair.most = change > pair.most ? change : pair.most;
  }

  Doubles slope_, intercept_;
  Pair low_, high_;
};

// Value `n` as a float.
template <class T>
class Conversion {
 public:
  Conversion(const char* raw, double slope, double intercept)
      : raw_(raw), slope_(slope), intercept_(intercept), scaled_(slope != 1 || intercept != 0) {}

  [[nodiscard]] float at(std::size_t n) const {
    const T value = stored(n);
    // Unscaled values keep their bits: -0 * 1 + 0 would be +0.
    if (scaled_) return floatOf(scaled(value), std::is_integral_v<T> || std::isfinite(static_cast<double>(value)));
    return std::is_same_v<T, double> ? floatOf(static_cast<double>(value)) : static_cast<float>(value);
  }

  // The same without a look at whether it is beyond the range of a float.
  [[nodiscard]] float quickAt(std::size_t n) const {
    const T value = stored(n);
    return scaled_ ? static_cast<float>(scaled(value)) : static_cast<float>(value);
  }
  // Whether it may be.
  [[nodiscard]] bool mayBeBeyond() const { return scaled_ || std::is_same_v<T, double>; }

  // Whether a float holds every number of the type.
  [[nodiscard]] bool isExact() const { return !scaled_ && (sizeof(T) < 4 || std::is_same_v<T, float>); }
  // Whether it holds those that became these kBrickVoxels floats: it holds all whole numbers up to 2^24.
  [[nodiscard]] bool isExact(const float* kept) const {
    return isExact() || (!scaled_ && std::is_integral_v<T> && allBelow(kept, 1 << 24));
  }

  [[nodiscard]] RoundedMany rounding() const { return {slope_, intercept_}; }
  // Adds a row of the `many` numbers from `first` on, which became `kept`.
  void count(std::size_t first, int many, const float* kept, RoundedMany& rounded, RoundedFew& others) const {
    if (!kIsLong && many == kBrickSize) {
      for (std::size_t n = 0; n < kBrickSize; n += 4) rounded.addFour<T>(raw_ + (first + n) * sizeof(T), kept + n);
      return;
    }
    for (int n = 0; n < many; ++n) {
      const T number = stored(first + static_cast<std::size_t>(n));
      const auto exact = static_cast<long double>(number);
      if (!kIsLong || static_cast<long double>(static_cast<double>(number)) == exact) {
        others.add(static_cast<double>(number) * slope_ + intercept_, kept[n]);
      } else {
        others.add(exact * slope_ + intercept_, kept[n]);
      }
    }
  }

 private:
  static constexpr bool kIsLong = std::is_integral_v<T> && sizeof(T) == 8;  // a double does not hold every one

  [[nodiscard]] T stored(std::size_t n) const {
    T value = 0;
    std::memcpy(&value, raw_ + n * sizeof(T), sizeof(T));
    return value;
  }
  [[nodiscard]] double scaled(T value) const { return static_cast<double>(value) * slope_ + intercept_; }

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

// What a brick lost of its voxels in the domain. It looks at the brick when that is whole: a float that has only just
// been written is slow to read together with its neighbour.
template <class T>
RoundedFew roundedOf(const Conversion<T>& conversion, const Vec3i& size, const Vec3i& brick, const float* values) {
  if (conversion.isExact(values)) return {};
  const Vec3i first = brick * kBrickSize;
  const Vec3i inside = (size - first).cwiseMin(kBrickSize);
  RoundedMany rounded = conversion.rounding();
  RoundedFew others;
  for (int k = 0; k < inside.z(); ++k) {
    for (int j = 0; j < inside.y(); ++j) {
      const std::size_t row = static_cast<std::size_t>(first.z() + k) * static_cast<std::size_t>(size.y()) +
                              static_cast<std::size_t>(first.y() + j);
      const std::size_t from = row * static_cast<std::size_t>(size.x()) + static_cast<std::size_t>(first.x());
      conversion.count(from, inside.x(), values + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize, rounded, others);
    }
  }
  RoundedFew all = rounded.all();
  all.count += others.count;
  all.most = std::max(all.most, others.most);
  return all;
}

// Fills a brick with at(n), the float of number `n`.
template <class At>
void fillBrick(const Vec3i& size, const Vec3i& brick, float* values, const At& at) {
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
        for (std::size_t i = 0; i < kBrickSize; ++i) values[i] = at(from + i);
      } else {
        for (int i = 0; i < kBrickSize; ++i) {
          values[i] = at(row + static_cast<std::size_t>(std::min(first.x() + i, last.x())));
        }
      }
      values += kBrickSize;
    }
  }
}

// Nearly all bricks hold only what a float can, so that is looked at for a brick at once.
template <class T>
Volume::BrickSource bricks(const Conversion<T>& conversion, const Vec3i& size, RoundedNumbers* rounded) {
  return [conversion, size, rounded](const Vec3i& brick, float* values) {
    fillBrick(size, brick, values, [&](std::size_t n) { return conversion.quickAt(n); });
    if (conversion.mayBeBeyond() && !allBelow(values, std::numeric_limits<float>::infinity()))
      fillBrick(size, brick, values, [&](std::size_t n) { return conversion.at(n); });
    if (rounded != nullptr) rounded->add(roundedOf(conversion, size, brick, values));
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

void RoundedNumbers::add(const RoundedFew& few) noexcept {
  if (few.count == 0) return;
  count_ += few.count;
  for (double known = most_; known < few.most && !most_.compare_exchange_weak(known, few.most);) {
  }
}

Rounding RoundedNumbers::of(const std::string& type, bool scaled) const {
  if (count_ == 0) return {};
  return {count_, most_, (scaled ? "scaled " : "") + type};
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
