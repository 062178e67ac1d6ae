// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/gradient.hpp"

#include "engine/reference/filter.hpp"

namespace palpate::reference {
namespace {

// The densities that a difference along one axis may read, and the voxel's index on that axis.
struct Line {
  const DenseField& field;
  Vec3i voxel;
  int axis;

  [[nodiscard]] float at(int steps) const {
    return bordered(field, voxel + steps * Vec3i::Unit(axis), Border::kNearest);
  }
  [[nodiscard]] bool has(int steps) const {
    const int c = voxel[axis];
    return c >= steps && c + steps < field.size[axis];
  }
  // 1 / (times * spacing), rounded to float once.
  [[nodiscard]] float inverse(double times) const {
    return static_cast<float>(1.0 / (times * field.lattice.spacing_m[axis]));
  }
};

float central(const Line& line) {
  const float difference = line.at(1) - line.at(-1);
  return difference * (line.has(1) ? line.inverse(2) : line.inverse(1));
}

float central4(const Line& line) {
  if (!line.has(2)) return central(line);
  // Over 32 up to here, so that nothing overflows but a gradient that does.
  const float near = line.at(1) / 4 - line.at(-1) / 4;
  const float far = line.at(2) / 32 - line.at(-2) / 32;
  return (near - far) * (32 * line.inverse(12));
}

// Weights 1, 2, 1. On two axes they sum to 16. Densities are divided by 16 beforehand (sixteenth), so that no sum
// overflows.
float smooth(float before, float middle, float after) {
  return (before + after) + (middle + middle);
}

float sixteenth(const DenseField& field, const Vec3i& voxel) {
  return bordered(field, voxel, Border::kNearest) / 16;
}

// Density smoothed along `first`, then along `second`.
float smooth2(const DenseField& field, const Vec3i& voxel, int first, int second) {
  std::array<float, 3> rows{};
  for (int s = -1; s <= 1; ++s) {
    const auto at = [&](int f) { return sixteenth(field, voxel + f * Vec3i::Unit(first) + s * Vec3i::Unit(second)); };
    rows[static_cast<std::size_t>(std::ptrdiff_t{s} + 1)] = smooth(at(-1), at(0), at(1));
  }
  return smooth(rows[0], rows[1], rows[2]);
}

float smooth1(const DenseField& field, const Vec3i& voxel, int axis) {
  const auto at = [&](int step) { return sixteenth(field, voxel + step * Vec3i::Unit(axis)); };
  return smooth(at(-1), at(0), at(1));
}

// The voxel that many steps away along an axis, or the outermost one.
Vec3i inDomain(const DenseField& field, const Vec3i& voxel) {
  return voxel.cwiseMax(0).cwiseMin(field.size - Vec3i::Ones());
}

float sobel(const Line& line) {
  const auto beside = [&](int steps) { return inDomain(line.field, line.voxel + steps * Vec3i::Unit(line.axis)); };
  float difference = 0;
  if (line.axis == 0) {
    difference = smooth2(line.field, beside(1), 1, 2) - smooth2(line.field, beside(-1), 1, 2);
  } else if (line.axis == 1) {
    std::array<float, 3> slices{};
    for (int k = -1; k <= 1; ++k) {
      const Vec3i after = inDomain(line.field, beside(1) + k * Vec3i::UnitZ());
      const Vec3i before = inDomain(line.field, beside(-1) + k * Vec3i::UnitZ());
      slices[static_cast<std::size_t>(std::ptrdiff_t{k} + 1)] =
          smooth1(line.field, after, 0) - smooth1(line.field, before, 0);
    }
    difference = smooth(slices[0], slices[1], slices[2]);
  } else {
    difference = smooth2(line.field, beside(1), 0, 1) - smooth2(line.field, beside(-1), 0, 1);
  }
  return difference * (line.has(1) ? line.inverse(2) : line.inverse(1));
}

}  // namespace

std::array<float, 3> gradientAt(const DenseField& field, const GradientOperator& gradient_operator, int i, int j,
                                int k) {
  std::array<float, 3> gradient{};
  for (int axis = 0; axis < 3; ++axis) {
    const Line line{field, {i, j, k}, axis};
    float& component = gradient[static_cast<std::size_t>(axis)];
    switch (gradient_operator.kind.stencil) {
      case GRADIENT_SOBEL:
        component = sobel(line);
        break;
      case GRADIENT_CENTRAL4:
        component = central4(line);
        break;
      default:
        component = central(line);
    }
  }
  return gradient;
}

DenseField smoothedFor(const GradientOperator& gradient_operator, DenseField field,
                       const std::function<void(double)>& progress) {
  const std::vector<FilterStep> steps = lowerFilters(gradient_operator.smoothing, field.lattice.spacing_m);
  return applyFilters(std::move(field), steps, progress);
}

}  // namespace palpate::reference
