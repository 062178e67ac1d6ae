// SPDX-License-Identifier: Apache-2.0
#include "apps/check/rounding_bound.hpp"

#include <cmath>
#include <cstdlib>

#include "engine/reference/filter.hpp"

namespace palpate {
namespace {

constexpr double kRounding = 0x1p-24;         // of one operation, as a share of its result
constexpr double kSmallest = 0x1p-149;        // of one operation whose result is a denormal
constexpr double kSmallestWeight = 0x1p-125;  // below it the kernel's exponential is 0
constexpr double kSecondOrder = 1.01;         // what products of roundings add, amply

// Each moved weight moves the mean by its share times its difference from the mean. Weights: 7 s^2 and 3.2 for the
// exponential, 3 for the taps' two products and its own. Two sums of n values, n u of the whole at most; the
// differences' and the products' rounding, the division and the last sum, once here and once in the twin's result.
double bilateralBound(const reference::DenseField& field, const Vec3i& voxel, const FilterStep& step, double twin) {
  const double here = reference::bordered(field, voxel, step.border);
  const std::size_t tap_y = static_cast<std::size_t>(step.reach.x()) + 2;
  const std::size_t tap_z = tap_y + static_cast<std::size_t>(step.reach.y()) + 1;
  const auto tap = [&step](std::size_t first, int offset) -> double {
    return step.taps[first + static_cast<std::size_t>(std::abs(offset))];
  };
  double weights = 0;
  double parts = 0;
  double moved = 0;  // in roundings
  double lost = 0;   // in densities: weights that are too small for a float
  int n = 0;
  for (int z = -step.reach.z(); z <= step.reach.z(); ++z) {
    for (int y = -step.reach.y(); y <= step.reach.y(); ++y) {
      for (int x = -step.reach.x(); x <= step.reach.x(); ++x, ++n) {
        const double difference = reference::bordered(field, voxel + Vec3i(x, y, z), step.border) - here;
        const double s = difference * step.taps[0];
        const double share = tap(1, x) * tap(tap_y, y) * tap(tap_z, z);
        const double weight = share * std::exp(-(s * s));
        const double from_mean = std::abs(difference) + std::abs(twin - here);
        weights += weight;
        parts += weight * std::abs(difference);
        moved += weight * (7 * s * s + 6.2) * from_mean;
        lost += (share * kSmallestWeight + 2 * kSmallest) * from_mean + 2 * kSmallest;
      }
    }
  }
  return kSecondOrder * (kRounding * (moved + parts * (2 * n + 4)) + lost) / weights + 2 * kRounding * std::abs(twin) +
         2 * kSmallest;
}

// Each of the six flows is off by (7 s^2 + 3.2 + 2) u of itself; their products with the rates and their sums by 5 u
// of all of them together; the last sum by u of the result, once here and once in the twin.
double diffusionBound(const reference::DenseField& field, const Vec3i& voxel, const FilterStep& step, double twin) {
  const double here = reference::bordered(field, voxel, step.border);
  double flows = 0;
  double moved = 0;
  double lost = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double rate = step.taps[static_cast<std::size_t>(axis)];
    for (const int way : {-1, 1}) {
      const double difference = reference::bordered(field, voxel + way * Vec3i::Unit(axis), step.border) - here;
      const double s = difference * step.taps[static_cast<std::size_t>(axis) + 3];
      const double flow = rate * std::exp(-(s * s)) * std::abs(difference);
      flows += flow;
      moved += flow * (7 * s * s + 5.2);
      lost += rate * (kSmallestWeight * std::abs(difference) + 2 * kSmallest) + 2 * kSmallest;
    }
  }
  return kSecondOrder * (kRounding * (moved + 5 * flows) + lost) + 2 * kRounding * std::abs(twin) + 2 * kSmallest;
}

}  // namespace

bool hasExponential(const FilterStep& step) noexcept {
  return step.kind == StepKind::kBilateral ||
         (step.kind == StepKind::kDiffuse && step.conductance == Conductance::kExp);
}

double roundingBound(const reference::DenseField& before, const Vec3i& voxel, const FilterStep& step, double twin) {
  return step.kind == StepKind::kBilateral ? bilateralBound(before, voxel, step, twin)
                                           : diffusionBound(before, voxel, step, twin);
}

const char* boundReason(const FilterStep& step) noexcept {
  return step.kind == StepKind::kBilateral
             ? "bilateral: exponentials are the kernel's own in float and the library's in the twin, in double; "
               "each weight may be off by (7 s^2 + 6.2) 2^-24 of itself, "
               "s the difference over sqrt(2) ranges, and n voxels add 2 n + 4 roundings"
             : "diffuse with g=exp: the same exponentials; each of six flows may be off by "
               "(7 s^2 + 5.2) 2^-24 of itself, s the slope over kappa, and their sums by 5 roundings";
}

}  // namespace palpate
