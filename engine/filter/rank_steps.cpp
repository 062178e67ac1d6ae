// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/rank_steps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kRounding = 1e-9;  // a length may fall this short of a voxel that it is meant to reach [voxel]

Vec3i windowReach(const FilterSpec& filter, const Vec3& spacing_m, const std::string& what, int largest) {
  Vec3i reach;
  for (int axis = 0; axis < 3; ++axis) {
    const double voxels = std::floor(filter.size.voxels(spacing_m[axis]) + kRounding);
    if (voxels > largest) {
      throw Error(Error::Code::kBadInput,
                  fmt::format("{} of radius {:g}{}", what, filter.size.value, filter.size.in_metres ? " m" : ""),
                  fmt::format("along axis {} it reaches {:g} voxels; {} are possible", "ijk"[axis], voxels, largest),
                  "make it smaller, or resample the volume to larger voxels");
    }
    reach[axis] = static_cast<int>(voxels);
  }
  return reach;
}

// The rows of a ball, the shortest first.
std::vector<ShapeRow> ballRows(const FilterSpec& filter, const Vec3& spacing_m, const Vec3i& reach) {
  const Vec3 radius_voxels(filter.size.voxels(spacing_m.x()), filter.size.voxels(spacing_m.y()),
                           filter.size.voxels(spacing_m.z()));
  std::vector<ShapeRow> rows;
  for (int dk = -reach.z(); dk <= reach.z(); ++dk) {
    for (int dj = -reach.y(); dj <= reach.y(); ++dj) {
      const double rest = 1 - std::pow(dj / radius_voxels.y(), 2) - std::pow(dk / radius_voxels.z(), 2);
      if (rest < -kRounding) continue;
      const double half = radius_voxels.x() * std::sqrt(std::max(rest, 0.0));
      rows.push_back({dj, dk, static_cast<int>(std::floor(half + kRounding))});
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const ShapeRow& a, const ShapeRow& b) { return a.half < b.half; });
  return rows;
}

void lowerBox(bool highest, const Vec3i& reach, std::vector<FilterStep>& steps) {
  for (int axis = 0; axis < 3; ++axis) {
    if (reach[axis] == 0) continue;
    FilterStep step;
    step.kind = highest ? StepKind::kHighestOnLine : StepKind::kLowestOnLine;
    step.axis = axis;
    step.reach = reach[axis] * Vec3i::Unit(axis);
    steps.push_back(std::move(step));
  }
}

void lowerBall(bool highest, const Vec3i& reach, const std::vector<ShapeRow>& rows, std::vector<FilterStep>& steps) {
  FilterStep step;
  step.kind = highest ? StepKind::kHighestInRows : StepKind::kLowestInRows;
  step.reach = reach;
  step.rows = rows;
  steps.push_back(std::move(step));
}

}  // namespace

void lowerMedian(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps) {
  FilterStep step;
  step.kind = StepKind::kMedian;
  step.reach = windowReach(filter, spacing_m, "median", kLargestMedian);
  step.border = filter.border;
  if (!step.reach.isZero()) steps.push_back(std::move(step));
}

void lowerMorphology(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps) {
  const bool ball = filter.shape == WindowShape::kBall;
  const Vec3i reach = windowReach(filter, spacing_m, ball ? "ball" : "box", ball ? kLargestBall : kLargestReach);
  if (reach.isZero()) return;
  const auto add = [&](bool highest) {
    if (ball) {
      lowerBall(highest, reach, ballRows(filter, spacing_m, reach), steps);
    } else {
      lowerBox(highest, reach, steps);
    }
  };
  if (filter.kind == FilterKind::kErode || filter.kind == FilterKind::kOpen) add(false);
  if (filter.kind != FilterKind::kErode) add(true);
  if (filter.kind == FilterKind::kClose) add(false);
}

}  // namespace palpate
