// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/brush_profile.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/units.hpp"
#include "engine/field/statistics.hpp"

namespace palpate {
namespace {

double bandOf(const Vec3& spacing_m) {
  return kRampVoxels * spacing_m.maxCoeff();
}

}  // namespace

BrushProfile brushProfile(double isovalue, double background, double object, const Vec3& spacing_m) {
  BrushProfile profile{isovalue, background, object, 0, bandOf(spacing_m)};
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

double brushShortfall(const EditCommand& command, const Lattice& lattice) {
  const Vec3 along = lattice.R_WL.transpose() * (command.to_W - command.from_W);
  const double r = command.radius_m, length = along.norm();
  const Vec3 h_per_r = lattice.spacing_m / r;
  const Vec3 t = length > 0 ? Vec3(along / length) : Vec3::Zero();
  const Vec3 across = Vec3::Ones() - t.cwiseProduct(t);
  // What is left of the ball's radius, and of the cylinder's.
  const double ball = std::max(1 - h_per_r.squaredNorm() / 18, 0.0);
  const double cylinder = std::max(1 - h_per_r.cwiseProduct(h_per_r).dot(across) / 24, 0.0);
  // Volumes over pi r^2.
  const double ball_volume = 4.0 / 3 * r;
  return 1 - (ball_volume * ball * ball * ball + length * cylinder * cylinder) / (ball_volume + length);
}

std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice) {
  if (!isBrush(command.kind)) return "";
  const bool has_ramp = (command.kind == EditKind::kAdd || command.kind == EditKind::kRemove) && !(command.falloff > 0);
  const double voxel_m = lattice.smallestSpacing();
  if (command.radius_m < voxel_m / 2) {
    return fmt::format(
        "its radius of {:g} mm is below half a voxel (of {:g} mm), which voxels cannot show: "
        "densities change up to {:g} mm around it, but the surface there may hardly move; "
        "give a larger one, or resample the volume",
        command.radius_m * kMillimetresPerMetre, voxel_m * kMillimetresPerMetre,
        (command.radius_m + (has_ramp ? bandOf(lattice.spacing_m) : 0)) * kMillimetresPerMetre);
  }
  const double shortfall = brushShortfall(command, lattice);
  if (!has_ramp || shortfall < kToldShortfall) return "";
  const Vec3 voxels = command.radius_m * lattice.spacing_m.cwiseInverse();
  return fmt::format(
      "its radius of {:g} mm is {:.2g} x {:.2g} x {:.2g} voxels: it {} some {:.0f} % less than its volume, since the "
      "surface "
      "between voxels is flatter than the brush; give a larger one, or resample the volume",
      command.radius_m * kMillimetresPerMetre, voxels.x(), voxels.y(), voxels.z(),
      command.kind == EditKind::kAdd ? "adds" : "removes", 100 * shortfall);
}

}  // namespace palpate
