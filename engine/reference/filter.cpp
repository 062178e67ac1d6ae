// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/filter.hpp"

#include <algorithm>
#include <cstdlib>

#include "engine/reference/rank_filter.hpp"

namespace palpate::reference {
namespace {

int inside(int c, int size, Border border) {
  while (border == Border::kMirror && (c < 0 || c >= size)) c = c < 0 ? -1 - c : 2 * size - 1 - c;
  return std::clamp(c, 0, size - 1);
}

// All taps from one end of the line to the other, each multiplied and then added.
float convolved(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const int reach = step.reach[step.axis];
  float sum = 0;
  for (int tap = -reach; tap <= reach; ++tap) {
    const float weight = step.taps[static_cast<std::size_t>(std::abs(tap))];
    const float part = weight * bordered(field, voxel + tap * Vec3i::Unit(step.axis), step.border);
    sum = tap == -reach ? part : sum + part;
  }
  return sum;
}

float result(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  switch (step.kind) {
    case StepKind::kConvolve:
      return convolved(field, voxel, step);
    case StepKind::kMedian:
    case StepKind::kHighestOnLine:
    case StepKind::kLowestOnLine:
    case StepKind::kHighestInRows:
    case StepKind::kLowestInRows:
      return picked(field, voxel, step);
  }
  return field.at(voxel.x(), voxel.y(), voxel.z());
}

}  // namespace

float bordered(const DenseField& field, const Vec3i& voxel, Border border) {
  return field.at(inside(voxel.x(), field.size.x(), border), inside(voxel.y(), field.size.y(), border),
                  inside(voxel.z(), field.size.z(), border));
}

DenseField applyStep(const DenseField& field, const FilterStep& step) {
  DenseField after = field;
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) after.values[field.offset(i, j, k)] = result(field, {i, j, k}, step);
    }
  }
  return after;
}

DenseField applyFilters(DenseField field, std::span<const FilterStep> steps) {
  for (const FilterStep& step : steps) field = applyStep(field, step);
  return field;
}

}  // namespace palpate::reference
