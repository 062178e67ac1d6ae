// SPDX-License-Identifier: Apache-2.0
#include "engine/field/few_values.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

#include "engine/field/statistics.hpp"

namespace palpate {
namespace {

// A set of up to kFewValues densities; of a mask's two zeros one.
class ValueSet {
 public:
  // False once there are more.
  bool add(float value) {
    if (value == last_ && !values_.empty()) return true;
    last_ = value;
    const float known = value == 0 ? 0.0F : value;
    for (std::size_t slot = hash(known);; slot = (slot + 1) % kSlots) {
      if (used_[slot] == 0) {
        if (values_.size() == kFewValues) return false;
        used_[slot] = 1;
        slots_[slot] = known;
        values_.push_back(known);
        return true;
      }
      if (slots_[slot] == known) return true;
    }
  }

  [[nodiscard]] std::vector<float> sorted() && {
    std::sort(values_.begin(), values_.end());
    return std::move(values_);
  }

 private:
  static constexpr unsigned kSlotBits = 10;
  static constexpr std::size_t kSlots = std::size_t{1} << kSlotBits;
  static_assert(kSlots >= 4 * kFewValues);
  // Multiplication by the golden ratio's bits; the upper ones are the most mixed.
  static std::size_t hash(float value) {
    return (std::bit_cast<std::uint32_t>(value) * 0x9e37'79b9U) >> (32U - kSlotBits);
  }

  std::array<char, kSlots> used_{};
  std::array<float, kSlots> slots_{};
  std::vector<float> values_;
  float last_ = 0;
};

using BrickValues = std::array<float, kBrickVoxels>;

struct Lines {
  std::uint64_t steps = 0, all = 0;
  [[nodiscard]] double share() const { return all > 0 ? static_cast<double>(steps) / static_cast<double>(all) : 1; }
};

class StepCount {
 public:
  explicit StepCount(float isovalue) : isovalue_(isovalue) {}

  // The lines of three within a brick, of its voxels in the domain. Most bricks lie on one side of the surface and have
  // none.
  void add(const BrickValues& values, const Vec3i& inside) {
    int objects = 0;
    for (const float value : values) objects += value > isovalue_ ? 1 : 0;
    if (objects == 0 || objects == kBrickVoxels) return;
    static constexpr std::array<int, 3> kStride = {1, kBrickSize, kBrickSize * kBrickSize};
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i first = Vec3i::Zero(), last = inside;
      first[axis] = 1;
      last[axis] -= 1;
      for (int k = first.z(); k < last.z(); ++k) {
        for (int j = first.y(); j < last.y(); ++j) {
          for (int i = first.x(); i < last.x(); ++i) {
            const float* middle =
                &values[static_cast<std::size_t>((std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize + i)];
            addLine(middle[-kStride[static_cast<std::size_t>(axis)]], *middle,
                    middle[kStride[static_cast<std::size_t>(axis)]]);
          }
        }
      }
    }
  }

  [[nodiscard]] double share() const { return std::min(inward_.share(), outward_.share()); }

 private:
  void addLine(float before, float middle, float after) {
    const bool is_object = middle > isovalue_;
    if ((before > isovalue_) == (after > isovalue_)) return;
    Lines& lines = is_object ? inward_ : outward_;
    const float same_side = (before > isovalue_) == is_object ? before : after;
    ++lines.all;
    lines.steps += same_side == middle ? 1 : 0;
  }

  float isovalue_;
  Lines inward_, outward_;
};

// Calls see(values, is_constant, inside) for each brick until it returns false; `inside`: its voxels in the domain. Of
// a constant brick there is one value. Returns whether all were seen.
template <class See>
bool seeBricks(const Volume& volume, const See& see) {
  BrickValues values{};
  const Vec3i bricks = volume.brickCount();
  for (int bk = 0; bk < bricks.z(); ++bk) {
    for (int bj = 0; bj < bricks.y(); ++bj) {
      for (int bi = 0; bi < bricks.x(); ++bi) {
        const Vec3i brick(bi, bj, bk);
        const bool is_constant = volume.readBrick(brick, values.data());
        if (!see(values, is_constant, (volume.size() - brick * kBrickSize).cwiseMin(Vec3i::Constant(kBrickSize))))
          return false;
      }
    }
  }
  return true;
}

}  // namespace

// Steps are counted in a fifth of the time that it takes to look up all values, and of a scan of 8 bits they decide. So
// they come first, with one row of each brick: that is enough to find the many values of a scan of 12 bits at once.
std::optional<FewValues> fewValuesOf(const Volume& volume, double isovalue) {
  if (!partsVolume(volume, isovalue)) return std::nullopt;
  ValueSet all;
  const auto areFew = [&](const BrickValues& values, int count) {
    return std::all_of(values.begin(), values.begin() + count, [&](float value) { return all.add(value); });
  };
  StepCount steps(static_cast<float>(isovalue));  // as kernels and servo compare
  const bool may_be = seeBricks(volume, [&](const BrickValues& values, bool is_constant, const Vec3i& inside) {
    if (!is_constant) steps.add(values, inside);
    return areFew(values, is_constant ? 1 : kBrickSize);
  });
  if (!may_be || steps.share() < kStepShare) return std::nullopt;
  const bool are_few = seeBricks(volume, [&](const BrickValues& values, bool is_constant, const Vec3i& /*inside*/) {
    return is_constant || areFew(values, kBrickVoxels);  // voxels outside the domain repeat some of it
  });
  if (!are_few) return std::nullopt;
  return FewValues{std::move(all).sorted(), steps.share()};
}

}  // namespace palpate
