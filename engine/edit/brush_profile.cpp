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
  const double object = meanAbove(volume, isovalue);
  const double minimum = volume.minimum();
  // A volume whose lowest density is the isovalue itself has nothing below it: what is removed must still be outside.
  const double contrast = object - isovalue;
  const double background = minimum < isovalue ? minimum : isovalue - contrast;
  return brushProfile(isovalue, background, object, volume.lattice().spacing_m);
}

}  // namespace palpate
