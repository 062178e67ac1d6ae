// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "engine/reference/distance.hpp"

namespace palpate::reference {
namespace {

int inside(int c, int size, Border border) {
  while (border == Border::kMirror && (c < 0 || c >= size)) c = c < 0 ? -1 - c : 2 * size - 1 - c;
  return std::clamp(c, 0, size - 1);
}

// Multiplies and adds tap by tap, from one end of the line to the other.
float convolved(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const int reach = step.reach[step.axis];
  float sum = 0;
  for (int tap = -reach; tap <= reach; ++tap) {
    const float weight = step.taps[static_cast<std::size_t>(std::abs(tap))];
    const float part = weight * bordered(field, voxel + tap * Vec3i::Unit(step.axis), step.border);
    sum = tap == -reach ? part : sum + part;
  }
  constexpr float kLargest = std::numeric_limits<float>::max();
  return std::clamp(sum, -kLargest, kLargest);  // a mean of densities is finite; rounding must not make it infinite
}

// The voxel plus the mean of the differences from it, weighted by place and by difference, in double.
float bilateral(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const auto tap = [&step](int axis, int offset) {
    std::ptrdiff_t place = 1 + std::abs(offset);
    for (int before = 0; before < axis; ++before) place += step.reach[before] + 1;
    return static_cast<double>(step.taps[static_cast<std::size_t>(place)]);
  };
  const double here = field.at(voxel.x(), voxel.y(), voxel.z());
  double parts = 0;
  double weights = 0;
  for (int z = -step.reach.z(); z <= step.reach.z(); ++z) {
    for (int y = -step.reach.y(); y <= step.reach.y(); ++y) {
      for (int x = -step.reach.x(); x <= step.reach.x(); ++x) {
        const double difference = bordered(field, voxel + Vec3i(x, y, z), step.border) - here;
        const double s = difference * step.taps[0];
        const double weight = tap(0, x) * tap(1, y) * tap(2, z) * std::exp(-(s * s));
        parts += weight * difference;
        weights += weight;
      }
    }
  }
  return static_cast<float>(here + parts / weights);
}

// The flow into the voxel from its neighbours on either side of each axis. A rational conductance is computed in float,
// an exponential one in double.
template <typename Real>
float diffused(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  const Real here = field.at(voxel.x(), voxel.y(), voxel.z());
  std::array<Real, 3> inflow{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto flow = [&](int side) {
      const Real difference = bordered(field, voxel + side * Vec3i::Unit(axis), step.border) - here;
      const Real s = difference * step.taps[3 + static_cast<std::size_t>(axis)];
      const Real conductance = step.conductance == Conductance::kExp ? std::exp(-(s * s)) : 1 / (1 + s * s);
      return conductance > 0 ? conductance * difference : 0;  // infinite differences count for nothing
    };
    inflow[static_cast<std::size_t>(axis)] = step.taps[static_cast<std::size_t>(axis)] * (flow(-1) + flow(1));
  }
  return static_cast<float>(here + ((inflow[0] + inflow[1]) + inflow[2]));
}

// -0 comes before +0.
bool ranksBefore(float a, float b) {
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

// The twin of the steps that pick one value of a neighbourhood: the median, the highest or the lowest.
float pickedByRank(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  std::vector<float> values =
      step.rows.empty() ? boxValues(field, voxel, step.reach, step.border) : shapeValues(field, voxel, step);
  if (step.kind == StepKind::kMedian) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end(), ranksBefore);
    return *middle;
  }
  const bool highest = step.kind == StepKind::kHighestOnLine || step.kind == StepKind::kHighestInRows;
  return highest ? *std::max_element(values.begin(), values.end(), ranksBefore)
                 : *std::min_element(values.begin(), values.end(), ranksBefore);
}

float result(const DenseField& field, const Vec3i& voxel, const FilterStep& step) {
  switch (step.kind) {
    case StepKind::kConvolve:
      return convolved(field, voxel, step);
    case StepKind::kBilateral:
      return bilateral(field, voxel, step);
    case StepKind::kDiffuse:
      return step.conductance == Conductance::kExp ? diffused<double>(field, voxel, step)
                                                   : diffused<float>(field, voxel, step);
    case StepKind::kDistanceSeed:
    case StepKind::kDistanceSpread:
    case StepKind::kDistanceFinish:
      break;  // applyFilters takes a distance as a whole
    case StepKind::kMedian:
    case StepKind::kHighestOnLine:
    case StepKind::kLowestOnLine:
    case StepKind::kHighestInRows:
    case StepKind::kLowestInRows:
      return pickedByRank(field, voxel, step);
  }
  return field.at(voxel.x(), voxel.y(), voxel.z());
}

}  // namespace

float bordered(const DenseField& field, const Vec3i& voxel, Border border) {
  return field.at(inside(voxel.x(), field.size.x(), border), inside(voxel.y(), field.size.y(), border),
                  inside(voxel.z(), field.size.z(), border));
}

DenseField applyStep(const DenseField& field, const FilterStep& step, const std::function<void(double)>& progress) {
  DenseField after = field;
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) after.values[field.offset(i, j, k)] = result(field, {i, j, k}, step);
    }
    if (progress) progress(static_cast<double>(k + 1) / field.size.z());
  }
  return after;
}

DenseField applyFilters(DenseField field, std::span<const FilterStep> steps,
                        const std::function<void(double)>& progress) {
  const auto all = static_cast<double>(steps.size());
  while (!steps.empty()) {
    const bool distance = steps[0].kind == StepKind::kDistanceSeed;
    const std::size_t count = distance ? kDistanceSteps : 1;
    const double before = all - static_cast<double>(steps.size());
    const auto tell = [&](double part) {
      if (progress) progress((before + part * static_cast<double>(count)) / all);
    };
    field = distance ? signedDistance(field, steps.first(count), tell) : applyStep(field, steps[0], tell);
    steps = steps.subspan(count);
  }
  return field;
}

}  // namespace palpate::reference
