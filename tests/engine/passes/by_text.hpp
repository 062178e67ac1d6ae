// SPDX-License-Identifier: Apache-2.0
// The gradient kernels' own source text (shaders/kernel_text.hpp), compiled for the CPU. A loop over voxels loads,
// calls the text and stores, as the kernel does over bricks. All arithmetic is in the text. For filters there is
// tests/engine/filter_passes/filters_by_text.hpp.
#pragma once

#include <array>

#include "engine/filter/filter_step.hpp"
#include "engine/gradient/gradient_operator.hpp"
#include "engine/reference/dense_field.hpp"
#include "shaders/gradient.layout.h"
#include "shaders/kernel_text.hpp"

namespace palpate::by_text {

using reference::DenseField;

template <typename Result>
void forEachVoxel(const DenseField& field, const Result& result) {
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) result(Vec3i(i, j, k), field.offset(i, j, k));
    }
  }
}

inline float at(const DenseField& field, const Vec3i& voxel, Border border = Border::kNearest) {
  const auto rule = border == Border::kMirror ? BORDER_MIRROR : BORDER_NEAREST;
  Vec3i inside;
  for (int axis = 0; axis < 3; ++axis) inside[axis] = kernel_text::insideOf(voxel[axis], field.size[axis], rule);
  return field.at(inside.x(), inside.y(), inside.z());
}

// ---- Gradients, without the smoothing of a Gaussian.

inline float stencilAt(const DenseField& field, const Vec3i& voxel, int axis, bool fourth) {
  const auto f = [&](int steps) { return at(field, voxel + steps * Vec3i::Unit(axis)); };
  const auto inverse = [&](double times) { return static_cast<float>(1 / (times * field.lattice.spacing_m[axis])); };
  return kernel_text::stencilGradient(fourth, static_cast<std::uint32_t>(voxel[axis]),
                                      static_cast<std::uint32_t>(field.size[axis] - 1), f(-2), f(-1), f(1), f(2),
                                      inverse(2), inverse(1), inverse(12));
}

inline kernel_text::SobelRow sobelRow(const DenseField& field, int first, int j, int k) {
  const auto f = [&](int i) { return at(field, Vec3i(first + i, j, k)); };
  kernel_text::SobelRow row;
  row.left = f(-1);
  row.right = f(8);
  row.low = kernel_text::vec4(f(0), f(1), f(2), f(3));
  row.high = kernel_text::vec4(f(4), f(5), f(6), f(7));
  return row;
}

inline std::array<float, 3> sobelAt(const DenseField& field, const Vec3i& voxel) {
  const int first = voxel.x() / 8 * 8;
  const auto slice = [&](int k) {
    return kernel_text::sobelSlice(sobelRow(field, first, voxel.y() - 1, k), sobelRow(field, first, voxel.y(), k),
                                   sobelRow(field, first, voxel.y() + 1, k));
  };
  const kernel_text::SobelDifferences d =
      kernel_text::sobelDifferences(slice(voxel.z() - 1), slice(voxel.z()), slice(voxel.z() + 1));
  const int i = voxel.x() - first;
  const auto pick = [i](const kernel_text::vec4& low, const kernel_text::vec4& high) {
    return i < 4 ? low[i] : high[i - 4];
  };
  const float along[] = {pick(d.x_low, d.x_high), pick(d.y_low, d.y_high), pick(d.z_low, d.z_high)};
  std::array<float, 3> gradient{};
  for (int axis = 0; axis < 3; ++axis) {
    const double h_m = field.lattice.spacing_m[axis];
    gradient[static_cast<std::size_t>(axis)] = kernel_text::sobelGradient(
        along[axis], static_cast<std::uint32_t>(voxel[axis]), static_cast<std::uint32_t>(field.size[axis] - 1),
        static_cast<float>(1 / (2 * h_m)), static_cast<float>(1 / h_m));
  }
  return gradient;
}

inline std::array<float, 3> gradientAt(const DenseField& field, const GradientOperator& gradient_operator,
                                       const Vec3i& voxel) {
  if (gradient_operator.kind.stencil == GRADIENT_SOBEL) return sobelAt(field, voxel);
  const bool fourth = gradient_operator.kind.stencil == GRADIENT_CENTRAL4;
  return {stencilAt(field, voxel, 0, fourth), stencilAt(field, voxel, 1, fourth), stencilAt(field, voxel, 2, fourth)};
}

}  // namespace palpate::by_text
