// SPDX-License-Identifier: Apache-2.0
#include "engine/field/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.hpp"
#include "engine/field/otsu.hpp"

namespace palpate {
namespace {

// Calls add(value, count) for every voxel of the domain, constant bricks at once.
template <class Add>
void forEachValue(const Volume& volume, const Add& add) {
  std::array<float, kBrickVoxels> values = {};
  const Vec3i bricks = volume.brickCount();
  for (int bk = 0; bk < bricks.z(); ++bk) {
    for (int bj = 0; bj < bricks.y(); ++bj) {
      for (int bi = 0; bi < bricks.x(); ++bi) {
        const Vec3i brick(bi, bj, bk);
        const Vec3i inside = (volume.size() - brick * kBrickSize).cwiseMin(Vec3i::Constant(kBrickSize));
        if (volume.readBrick(brick, values.data())) {
          add(static_cast<double>(values[0]), static_cast<std::uint64_t>(inside.prod()));
          continue;
        }
        for (int k = 0; k < inside.z(); ++k) {
          for (int j = 0; j < inside.y(); ++j) {
            const float* row = values.data() + (std::ptrdiff_t{k} * kBrickSize + j) * kBrickSize;
            for (int i = 0; i < inside.x(); ++i) add(static_cast<double>(row[i]), std::uint64_t{1});
          }
        }
      }
    }
  }
}

void fillHistogram(const Volume& volume, int bins, VolumeStatistics& statistics) {
  Histogram& histogram = statistics.histogram;
  histogram.low = statistics.minimum;
  histogram.bin_width = (statistics.maximum - statistics.minimum) / bins;
  histogram.counts.assign(static_cast<std::size_t>(bins), 0);
  double sum = 0;
  double count = 0;
  double lowest = 0;  // voxels that hold the minimum
  double next = statistics.maximum;
  forEachValue(volume, [&](double value, std::uint64_t voxels) {
    if (value == statistics.minimum) {
      lowest += static_cast<double>(voxels);
    } else {
      next = std::min(next, value);
    }
    const double place = histogram.bin_width > 0 ? (value - histogram.low) / histogram.bin_width : 0;
    histogram.counts[static_cast<std::size_t>(std::min(place, bins - 1.0))] += voxels;
    sum += value * static_cast<double>(voxels);
    count += static_cast<double>(voxels);
  });
  statistics.mean = sum / count;
  const double others = statistics.maximum - next;
  if (others > 0 && next - statistics.minimum > others) statistics.fill_share = lowest / count;
}

// Hounsfield units: air near -1000 and bone well above 0.
bool looksLikeHounsfield(const VolumeStatistics& statistics) {
  return statistics.minimum <= -900 && statistics.minimum >= -10000 && statistics.maximum >= 300;
}

bool parts(double lowest, double highest, double isovalue) {
  return lowest <= isovalue && isovalue < highest;
}

std::vector<IsovalueSuggestion> suggest(const VolumeFacts& facts, const VolumeStatistics& statistics) {
  std::vector<IsovalueSuggestion> all;
  if (facts.kept_isovalue) all.push_back({*facts.kept_isovalue, "kept in the file"});
  if (facts.declared_isovalue) all.push_back({*facts.declared_isovalue, "the phantom's exact surface"});
  if (facts.is_level_set) all.push_back({0, "the level set's surface"});
  if (!facts.declared_isovalue && !facts.is_level_set && looksLikeHounsfield(statistics)) {
    all.push_back({226, "bone in a CT (InVesalius preset)"});
    all.push_back({300, "compact bone in a CT"});
    all.push_back({-300, "skin in a CT"});
  }
  all.push_back({otsuThreshold(statistics.histogram), "Otsu's threshold, two classes"});
  const auto [lower, upper] = otsuThresholds(statistics.histogram);
  all.push_back({lower, "Otsu's lower threshold, three classes"});
  all.push_back({upper, "Otsu's upper threshold, three classes"});
  std::erase_if(
      all, [&](const IsovalueSuggestion& one) { return !parts(statistics.minimum, statistics.maximum, one.isovalue); });
  return all;
}

[[noreturn]] void refuseConstant(const Volume& volume) {
  throw Error(Error::Code::kBadInput, volume.facts().source,
              fmt::format("every voxel is {:g}; there is no isosurface", volume.minimum()),
              "give a volume that varies");
}

// `isovalue`: `value` in words.
[[noreturn]] void refuseIsovalue(const Volume& volume, double value, const std::string& isovalue) {
  std::string suggestions;
  for (const IsovalueSuggestion& one : statisticsOf(volume).suggestions) {
    suggestions += fmt::format("{}{:g} ({})", suggestions.empty() ? "" : ", ", one.isovalue, one.reason);
  }
  const auto [low, high] = std::pair(volume.minimum(), volume.maximum());
  const std::string reason =
      value == static_cast<double>(high)
          ? fmt::format("{} is the highest of its values, {:g} to {:g}, and object is only what is denser", isovalue,
                        low, high)
          : fmt::format("{} is outside its values, {:g} to {:g}", isovalue, low, high);
  throw Error(Error::Code::kBadInput, volume.facts().source, reason, "try " + suggestions);
}

}  // namespace

VolumeStatistics statisticsOf(const Volume& volume, int bins) {
  constexpr int kMostBins = 1000000;
  if (bins < 1 || bins > kMostBins) {
    throw Error(Error::Code::kBadInput, "histogram", fmt::format("{} bins", bins),
                fmt::format("ask for 1 to {}", kMostBins));
  }
  constexpr int kOtsuBins = 256;
  VolumeStatistics statistics;
  statistics.minimum = static_cast<double>(volume.minimum());
  statistics.maximum = static_cast<double>(volume.maximum());
  fillHistogram(volume, kOtsuBins, statistics);
  statistics.suggestions = suggest(volume.facts(), statistics);  // none parts a constant volume
  if (bins != kOtsuBins) fillHistogram(volume, bins, statistics);
  return statistics;
}

double meanAbove(const Volume& volume, double isovalue) {
  double sum = 0;
  double count = 0;
  forEachValue(volume, [&](double value, std::uint64_t voxels) {
    if (value <= isovalue) return;
    sum += value * static_cast<double>(voxels);
    count += static_cast<double>(voxels);
  });
  return count > 0 ? sum / count : static_cast<double>(volume.maximum());
}

double defaultIsovalue(const Volume& volume) {
  if (!(volume.minimum() < volume.maximum())) refuseConstant(volume);
  // A kept isovalue that is damaged, or without any object above it, is not silently replaced by another one.
  const std::optional<double>& kept = volume.facts().kept_isovalue;
  if (kept && !partsVolume(volume, *kept))
    refuseIsovalue(volume, *kept, fmt::format("the isovalue {:g} that it keeps", *kept));
  return statisticsOf(volume).suggestions.at(0).isovalue;
}

bool partsVolume(const Volume& volume, double isovalue) {
  return parts(static_cast<double>(volume.minimum()), static_cast<double>(volume.maximum()), isovalue);
}

void checkIsovalue(const Volume& volume, double isovalue) {
  if (!(volume.minimum() < volume.maximum())) refuseConstant(volume);
  if (!partsVolume(volume, isovalue)) refuseIsovalue(volume, isovalue, fmt::format("isovalue {:g}", isovalue));
}

}  // namespace palpate
