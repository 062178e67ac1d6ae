// SPDX-License-Identifier: Apache-2.0
#include "apps/load/stair_words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "engine/field/few_values.hpp"

namespace palpate {
namespace {

constexpr std::size_t kMostListed = 6;

// "2 values (0, 1)", "117 values (0 to 116)"
std::string valueWords(const std::vector<float>& values) {
  if (values.size() <= kMostListed) return fmt::format("{} values ({:g})", values.size(), fmt::join(values, ", "));
  return fmt::format("{} values ({:g} to {:g})", values.size(), values.front(), values.back());
}

std::string filterWords(FilterGiven given) {
  if (given == FilterGiven::kAsOption) return fmt::format("--filter {}", kStairFilter);
  return fmt::format("'palpate filter IN -o smooth.vdb --filter {}'", kStairFilter);
}

// Labels are names, not densities: those above the isovalue are felt as one, and a low-pass moves the surface of each
// by another length, since the isovalue is half-way between two of them at most. So it is no remedy, and a plan that
// has one is told the same.
std::string labelWords(const std::vector<float>& values, double isovalue, FilterGiven given) {
  const float lowest = *std::upper_bound(values.begin(), values.end(), static_cast<float>(isovalue));
  const std::string felt = lowest == values.back()
                               ? fmt::format("label {:g} alone", lowest)
                               : fmt::format("those from {:g} to {:g} as one object", lowest, values.back());
  return fmt::format(
      "; if these are labels, isovalue {:g} feels {}: write the label that you want as a mask of 0 and 1, "
      "and smooth that ({}; docs/masks.md)",
      isovalue, felt, filterWords(given));
}

}  // namespace

bool smoothsStairs(const Plan& plan, const Vec3& spacing_m, double contrast) {
  constexpr double kRounding = 1e-9;  // of a length over a spacing
  std::vector<FilterSpec> all = plan.filters;
  all.insert(all.end(), plan.gradient.smoothing.begin(), plan.gradient.smoothing.end());
  Vec3 variance = Vec3::Zero();  // [voxel^2]
  for (const FilterSpec& filter : all) {
    if (filter.kind == FilterKind::kDiffuse) return true;
    if (filter.kind == FilterKind::kBilateral && filter.range >= contrast) return true;
    if (filter.kind != FilterKind::kGaussian) continue;
    for (int axis = 0; axis < 3; ++axis) {
      const double sigma = filter.size.voxels(spacing_m[axis]);
      variance[axis] += sigma * sigma;
    }
  }
  return std::sqrt(variance.minCoeff()) >= kLeastSmoothing_voxel - kRounding;
}

Stairs stairsOf(const Volume& volume, double isovalue) {
  auto found = fewValuesOf(volume, isovalue);
  return {.values = found ? std::move(found->values) : std::vector<float>{}, .spacing_m = volume.lattice().spacing_m};
}

std::string stairWords(const Volume& volume, double isovalue, const Plan& plan, FilterGiven given) {
  return stairWords(stairsOf(volume, isovalue), isovalue, plan, given);
}

std::string stairWords(const Stairs& stairs, double isovalue, const Plan& plan, FilterGiven given) {
  const std::vector<float>& values = stairs.values;
  const auto threshold = static_cast<float>(isovalue);  // as kernels and servo compare
  if (values.empty() || !(values.front() <= threshold && threshold < values.back())) return {};
  const double contrast = static_cast<double>(values.back()) - static_cast<double>(values.front());
  const bool is_smooth = smoothsStairs(plan, stairs.spacing_m, contrast), is_mask = values.size() == 2;
  if (is_smooth && is_mask) return {};
  std::string words = fmt::format("it holds {}", valueWords(values));
  if (!is_smooth) words += ", so its surface is felt as stairs";
  if (!is_mask) return words + labelWords(values, isovalue, given);
  words += fmt::format(": {} smooths them, but removes walls thinner than 2 voxels and rods thinner than 4",
                       filterWords(given));
  if (given == FilterGiven::kAsOption) {
    words += fmt::format("; --filter {} --gradient-operator {} is as smooth and removes less", kGentleFilter,
                         kGentleGradient);
  }
  return words + " (docs/masks.md)";
}

}  // namespace palpate
