// SPDX-License-Identifier: Apache-2.0
// engine/field/statistics.hpp: statistics of a volume's values, and isovalues worth trying.
//
// An isovalue separates object (density above it) from background, so it must lie in [minimum, maximum).
// Thread: any, while nobody changes the volume. Cost: one pass over the stored bricks (60 ms for 256^3).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/field/volume.hpp"

namespace palpate {

struct Histogram {
  double low = 0;                     // lower edge of the first bin [density]
  double bin_width = 0;               // [density]; the last bin holds the maximum too
  std::vector<std::uint64_t> counts;  // [voxel]
};

struct IsovalueSuggestion {
  double isovalue = 0;  // [density]
  std::string reason;   // "bone in a CT (InVesalius preset)", "Otsu's threshold", ...
};

struct VolumeStatistics {
  double minimum = 0;  // [density]
  double maximum = 0;
  double mean = 0;
  Histogram histogram;
  // Share of the voxels that hold the minimum, if the minimum most likely means "no data"; otherwise 0. It does so if
  // the next value is farther above it than all other values lie apart, and these others are not all equal.
  double fill_share = 0;
  std::vector<IsovalueSuggestion> suggestions;  // the best first; empty for a constant volume
};

// Refuses (Error kBadInput) a bin count outside [1, 1000000].
[[nodiscard]] VolumeStatistics statisticsOf(const Volume& volume, int bins = 256);

// Mean of the densities above the isovalue; the maximum where there are none. Cost: one pass.
[[nodiscard]] double meanAbove(const Volume& volume, double isovalue);

// The first suggestion: the isovalue that the file keeps, a phantom's declared one, 0 for a level set, 226 (bone) for
// values in Hounsfield units, otherwise Otsu's threshold. Throws Error(kBadInput) for a constant volume, and for a kept
// isovalue that is NaN or outside [minimum, maximum).
[[nodiscard]] double defaultIsovalue(const Volume& volume);

// Whether [minimum, maximum) holds the isovalue, so that there is both object and background.
[[nodiscard]] bool partsVolume(const Volume& volume, double isovalue);

// Throws Error(kBadInput) unless [minimum, maximum) holds the isovalue; the message gives the range and the
// suggestions.
void checkIsovalue(const Volume& volume, double isovalue);

}  // namespace palpate
