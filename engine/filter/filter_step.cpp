// SPDX-License-Identifier: Apache-2.0
#include "engine/filter/filter_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"
#include "engine/filter/rank_steps.hpp"
#include "shaders/filter_distance.layout.h"

namespace palpate {
namespace {

// A Gaussian that takes a smaller share than this from its middle voxel is left out.
constexpr double kNoEffect = 1e-9;

int reachOf(const FilterSpec& filter, double voxels, int axis, int largest = kLargestReach) {
  const double reach = std::ceil(voxels - 1e-9);
  if (reach <= largest) return static_cast<int>(reach);
  throw Error(Error::Code::kBadInput,
              filter.size.in_metres
                  ? fmt::format("{} of {:g} mm", filterName(filter.kind), filter.size.value / kMetresPerMillimetre)
                  : fmt::format("{} of {:g} voxels", filterName(filter.kind), filter.size.value),
              fmt::format("along axis {} it reaches {:g} voxels; {} are possible", "ijk"[axis], reach, largest),
              "make it smaller");
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

void lowerBilateral(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps) {
  FilterStep step{StepKind::kBilateral, 0, Vec3i::Zero(), filter.border, {}};
  step.taps.push_back(static_cast<float>(1 / (std::sqrt(2.0) * filter.range)));
  bool any = false;
  for (int axis = 0; axis < 3; ++axis) {
    const double sigma = filter.size.voxels(spacing_m[axis]);
    step.reach[axis] = reachOf(filter, filter.truncate * sigma, axis, kLargestBilateralReach);
    const std::vector<float> taps = gaussianTaps(sigma, step.reach[axis]);
    any = any || 1 - taps[0] > kNoEffect;
    step.taps.insert(step.taps.end(), taps.begin(), taps.end());
  }
  if (any) steps.push_back(std::move(step));
}

void lowerDiffusion(const FilterSpec& filter, const Vec3& spacing_m, std::vector<FilterStep>& steps) {
  const double bound = stableTimeStep(spacing_m);
  const double dt = filter.dt_mm2.value_or(bound / 2);
  if (dt > bound * (1 + 1e-12)) {
    throw Error(Error::Code::kBadInput, fmt::format("filter diffuse with dt={:g}", dt),
                fmt::format("with these voxels a time step is stable up to {:.6g} mm^2", bound),
                "make dt smaller, or leave it out for half of that");
  }
  const Vec3 spacing_mm = spacing_m * kMillimetresPerMetre;
  FilterStep step{StepKind::kDiffuse, 0, Vec3i::Ones(), Border::kNearest, {}};
  step.conductance = filter.conductance;
  for (const double h : spacing_mm) step.taps.push_back(static_cast<float>(dt / (h * h)));
  for (const double h : spacing_mm) step.taps.push_back(static_cast<float>(1 / (filter.kappa * h)));
  steps.insert(steps.end(), static_cast<std::size_t>(filter.size.value), step);
}

// Lengths are in units of the smallest spacing, so that nothing depends on the unit of the file.
void lowerDistance(const FilterSpec& filter, const Vec3& spacing_m, std::optional<float> isovalue,
                   std::vector<FilterStep>& steps) {
  if (!isovalue) {
    throw Error(Error::Code::kBadInput, "filter distance", "it needs to know where the surface is", "give an isovalue");
  }
  const double unit_m = spacing_m.minCoeff();
  const Vec3 edge = spacing_m / unit_m;
  FilterStep seed{StepKind::kDistanceSeed, 0, Vec3i::Ones(), Border::kNearest, {}};
  seed.taps.resize(DISTANCE_TAPS);
  seed.taps[DISTANCE_ISOVALUE] = *isovalue;
  seed.taps[DISTANCE_BAND] = static_cast<float>(filter.size.value);
  seed.taps[DISTANCE_UNIT] = static_cast<float>(unit_m);
  seed.taps[DISTANCE_SLACK] = static_cast<float>(edge.norm() / 2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto length = static_cast<float>(edge[static_cast<int>(axis)]);
    seed.taps[DISTANCE_EDGE + axis] = length;
    seed.taps[DISTANCE_EDGE_SQUARE + axis] = length * length;
  }
  steps.push_back(seed);
  for (int axis = 0; axis < 3; ++axis) {
    FilterStep spread = seed;
    spread.kind = StepKind::kDistanceSpread;
    spread.axis = axis;
    // One voxel more than the band: the voxel that knows the nearest surface point may lie one voxel beyond that point.
    const int reach = static_cast<int>(std::ceil(filter.size.value / edge[axis] - 1e-9)) + 1;
    spread.reach = reach * Vec3i::Unit(axis);
    steps.push_back(std::move(spread));
  }
  seed.kind = StepKind::kDistanceFinish;
  steps.push_back(std::move(seed));
}

// Adds the taps in the order of the kernel: from the far end on one side to the far end on the other.
float convolved(const FilterStep& step, float density) {
  const int reach = step.reach[step.axis];
  float sum = step.taps[static_cast<std::size_t>(reach)] * density;
  for (int tap = 1 - reach; tap <= reach; ++tap)
    sum = sum + step.taps[static_cast<std::size_t>(std::abs(tap))] * density;
  constexpr float kLargest = std::numeric_limits<float>::max();
  return std::clamp(sum, -kLargest, kLargest);
}

}  // namespace

std::vector<FilterStep> lowerFilters(std::span<const FilterSpec> filters, const Vec3& spacing_m,
                                     std::optional<float> isovalue) {
  std::vector<FilterStep> steps;
  for (const FilterSpec& filter : filters) {
    switch (filter.kind) {
      case FilterKind::kGaussian:
        lowerGaussian(filter, spacing_m, steps);
        break;
      case FilterKind::kBilateral:
        lowerBilateral(filter, spacing_m, steps);
        break;
      case FilterKind::kDiffuse:
        lowerDiffusion(filter, spacing_m, steps);
        break;
      case FilterKind::kDistance:
        lowerDistance(filter, spacing_m, isovalue, steps);
        isovalue = 0.0F;
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

double stableTimeStep(const Vec3& spacing_m) noexcept {
  return 1 / (2 * (spacing_m * kMillimetresPerMetre).cwiseAbs2().cwiseInverse().sum());
}

float distanceBand(const FilterStep& step) noexcept {
  return step.taps[DISTANCE_BAND] * step.taps[DISTANCE_UNIT];
}

float uniformResult(const FilterStep& step, float density) {
  switch (step.kind) {
    case StepKind::kConvolve:
      return convolved(step, density);
    case StepKind::kBilateral:
    case StepKind::kDiffuse:
      return density + 0.0F;  // the sum that is added is 0, which turns -0 into +0
    case StepKind::kDistanceSeed:
    case StepKind::kDistanceSpread:
      return 0;  // DISTANCE_NONE
    case StepKind::kDistanceFinish:
      return density > step.taps[DISTANCE_ISOVALUE] ? distanceBand(step) : -distanceBand(step);
    case StepKind::kMedian:
    case StepKind::kHighestOnLine:
    case StepKind::kLowestOnLine:
    case StepKind::kHighestInRows:
    case StepKind::kLowestInRows:
      return density;  // it picks a density of the neighbourhood
  }
  return density;
}

}  // namespace palpate
