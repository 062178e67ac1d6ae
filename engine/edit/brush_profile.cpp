// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/brush_profile.hpp"

#include <algorithm>

#include "engine/volume/statistics.hpp"

namespace palpate {

BrushProfile brushProfile(double isovalue, double background, double object, const Vec3& spacing_m) {
  BrushProfile profile{isovalue, background, object, 0, kRampVoxels * spacing_m.maxCoeff()};
  profile.slope_per_m = std::min(isovalue - background, object - isovalue) / profile.band_m;
  return profile;
}

double slopeTowards(const BrushProfile& profile, double object) {
  return std::min(profile.slope_per_m, (object - profile.isovalue) / profile.band_m);
}

double rampDepth(const BrushProfile& profile, double object) {
  return std::max(object - profile.isovalue, profile.isovalue - profile.background) / slopeTowards(profile, object);
}

BrushProfile brushProfile(const Volume& volume, double isovalue) {
  checkIsovalue(volume, isovalue);
  const VolumeStatistics statistics = statisticsOf(volume);
  const Histogram& histogram = statistics.histogram;
  double sum = 0;
  double count = 0;
  for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
    const double middle = histogram.low + (static_cast<double>(bin) + 0.5) * histogram.bin_width;
    if (middle <= isovalue) continue;
    sum += middle * static_cast<double>(histogram.counts[bin]);
    count += static_cast<double>(histogram.counts[bin]);
  }
  const double object = count > 0 ? sum / count : statistics.maximum;
  // A volume whose lowest density is the isovalue itself has nothing below it: what is removed must still be outside.
  const double contrast = object - isovalue;
  const double background = statistics.minimum < isovalue ? statistics.minimum : isovalue - contrast;
  return brushProfile(isovalue, background, object, volume.lattice().spacing_m);
}

}  // namespace palpate
