// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/rank_filter.hpp"

#include <algorithm>
#include <cmath>

#include "engine/reference/filter.hpp"

namespace palpate::reference {
namespace {

bool before(float a, float b) {
  return a < b || (a == b && std::signbit(a) && !std::signbit(b));
}

std::vector<float> boxValues(const DenseField& field, const Vec3i& voxel, const Vec3i& reach, Border border) {
  std::vector<float> values;
  for (int dk = -reach.z(); dk <= reach.z(); ++dk) {
    for (int dj = -reach.y(); dj <= reach.y(); ++dj) {
      for (int di = -reach.x(); di <= reach.x(); ++di) {
        values.push_back(bordered(field, voxel + Vec3i(di, dj, dk), border));
      }
    }
  }
  return values;
}

std::vector<float> shapeValues(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  std::vector<float> values;
  for (const ShapeRow& row : step.rows) {
    for (int di = -row.half; di <= row.half; ++di) {
      values.push_back(bordered(field, voxel + Vec3i(di, row.dj, row.dk), step.border));
    }
  }
  return values;
}

}  // namespace

float picked(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  std::vector<float> values =
      step.rows.empty() ? boxValues(field, voxel, step.reach, step.border) : shapeValues(field, voxel, step);
  if (step.kind == StepKind::kMedian) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end(), before);
    return *middle;
  }
  const bool highest = step.kind == StepKind::kHighestOnLine || step.kind == StepKind::kHighestInRows;
  return highest ? *std::max_element(values.begin(), values.end(), before)
                 : *std::min_element(values.begin(), values.end(), before);
}

}  // namespace palpate::reference
