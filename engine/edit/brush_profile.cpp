// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/brush_profile.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/units.hpp"
#include "engine/field/statistics.hpp"

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
  // If the lowest density is the isovalue itself, no density of the volume lies below it. What is removed must still be
  // outside.
  const double contrast = object - isovalue;
  const double background = minimum < isovalue ? minimum : isovalue - contrast;
  return brushProfile(isovalue, background, object, volume.lattice().spacing_m);
}

std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice, const BrushProfile& profile) {
  const double voxel_m = lattice.smallestSpacing();
  if (!isBrush(command.kind) || command.radius_m >= voxel_m / 2) return "";
  return fmt::format(
      "its radius of {:g} mm is below half a voxel (of {:g} mm), which voxels cannot show: "
      "densities change up to {:g} mm around it, but the surface there may hardly move; "
      "give a larger one, or resample the volume",
      command.radius_m * kMillimetresPerMetre, voxel_m * kMillimetresPerMetre,
      (command.radius_m + profile.band_m) * kMillimetresPerMetre);
}

}  // namespace palpate
