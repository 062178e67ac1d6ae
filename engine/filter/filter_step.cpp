// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_step.hpp"

#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/filter/rank_steps.hpp"

namespace palpate {
namespace {

constexpr double kNoEffect = 1e-9;  // the share that a Gaussian takes from its middle voxel, below which it is left out

int reachOf(const FilterSpec& filter, double voxels, int axis) {
  const double reach = std::ceil(voxels - 1e-9);
  if (reach <= kLargestReach) return static_cast<int>(reach);
  throw Error(Error::Code::kBadInput,
              fmt::format("filter of size {:g}{}", filter.size.value, filter.size.in_metres ? " m" : ""),
              fmt::format("along axis {} it reaches {:g} voxels; {} are possible", "ijk"[axis], reach, kLargestReach),
              "make it smaller, or resample the volume to larger voxels");
}

// Samples of exp(-x^2 / (2 sigma^2)), scaled so that all taps sum to one before they are rounded.
std::vector<float> gaussianTaps(double sigma_voxels, int reach) {
  std::vector<double> weights;
  for (int x = 0; x <= reach; ++x) weights.push_back(std::exp(-0.5 * (x * x) / (sigma_voxels * sigma_voxels)));
  const double sum = 2 * std::accumulate(weights.begin() + 1, weights.end(), 0.0) + weights[0];
  std::vector<float> taps;
  for (const double weight : weights) taps.push_back(static_cast<float>(weight / sum));
  return taps;
}

void lowerGaussian(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps) {
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = filter.size.voxels(spacing_m[axis]);
    FilterStep step{StepKind::kConvolve, axis, reachOf(filter, filter.truncate * sigma, axis) * Vec3i::Unit(axis),
                    filter.border,       {},   {}};
    step.taps = gaussianTaps(sigma, step.reach[axis]);
    if (1 - step.taps[0] > kNoEffect) steps.push_back(std::move(step));
  }
}

// As the kernel adds its taps up: from the far end on one side to the far end on the other.
float convolved(const FilterStep& step, float density) {
  const int reach = step.reach[step.axis];
  float sum = step.taps[static_cast<std::size_t>(reach)] * density;
  for (int tap = 1 - reach; tap <= reach; ++tap)
    sum = sum + step.taps[static_cast<std::size_t>(std::abs(tap))] * density;
  return sum;
}

}  // namespace

std::vector<FilterStep> lowerFilters(std::span<const FilterSpec> filters, const Vec3& spacing_m) {
  std::vector<FilterStep> steps;
  for (const FilterSpec& filter : filters) {
    switch (filter.kind) {
      case FilterKind::kGaussian:
        lowerGaussian(filter, spacing_m, steps);
        break;
      case FilterKind::kMedian:
        lowerMedian(filter, spacing_m, steps);
        break;
      case FilterKind::kDilate:
      case FilterKind::kErode:
      case FilterKind::kOpen:
      case FilterKind::kClose:
        lowerMorphology(filter, spacing_m, steps);
        break;
    }
  }
  return steps;
}

Vec3i totalReach(std::span<const FilterStep> steps) {
  Vec3i reach = Vec3i::Zero();
  for (const FilterStep& step : steps) reach += step.reach;
  return reach;
}

float uniformResult(const FilterStep& step, float density) {
  switch (step.kind) {
    case StepKind::kConvolve:
      return convolved(step, density);
    case StepKind::kMedian:
    case StepKind::kHighestOnLine:
    case StepKind::kLowestOnLine:
    case StepKind::kHighestInRows:
    case StepKind::kLowestInRows:
      return density;  // one of those that are there
  }
  return density;
}

}  // namespace palpate
