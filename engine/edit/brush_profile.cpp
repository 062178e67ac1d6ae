// SPDX-License-Identifier: Apache-2.0
#include "engine/edit/brush_profile.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "engine/field/statistics.hpp"

namespace palpate {
namespace {

double bandOf(const Vec3& spacing_m) {
  return kRampVoxels * spacing_m.maxCoeff();
}

double fadeOf(const EditCommand& command, Strokes strokes) {
  return makesSurface(command.kind) && strokes == Strokes::kOne ? command.falloff * command.radius_m : 0;
}

// How far under a brush's rim its surface lies on a wide plane [m], where voxels blur the density over a distance of
// this variance [m^2]. What trilinear interpolation does to it between voxels is the same on average.
double surfaceDepth(double fade_m, double band_m, double variance_m2) {
  if (fade_m <= 0) return 0;            // the ramp is as long on either side
  const auto density = [&](double u) {  // above the isovalue, over the contrast
    const double s = std::clamp(u / fade_m, 0.0, 1.0), w = s * s * (3 - 2 * s);
    return 1 - w - w * std::min(u / band_m, 1.0);
  };
  const double half_m = std::sqrt(6 * variance_m2);  // of a hat
  const auto blurred = [&](double u) {
    constexpr int kParts = 24;
    double sum = 0;
    for (int n = 0; n < kParts; ++n) {
      const double x = (2.0 * n + 1) / kParts - 1;
      sum += (1 - std::abs(x)) * density(u + half_m * x);
    }
    return sum;
  };
  double low = 0, high = fade_m + half_m;
  for (int n = 0; n < 40; ++n) {
    const double u = (low + high) / 2;
    (blurred(u) > 0 ? low : high) = u;
  }
  return low;
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

double surfaceRadius(const EditCommand& command, const Lattice& lattice, Strokes strokes) {
  return std::max(command.radius_m - surfaceDepth(fadeOf(command, strokes), bandOf(lattice.spacing_m), 0), 0.0);
}

double brushShortfall(const EditCommand& command, const Lattice& lattice, Strokes strokes) {
  const Vec3 along = lattice.R_WL.transpose() * (command.to_W - command.from_W);
  const double length = along.norm();
  const Vec3 t = length > 0 ? Vec3(along / length) : Vec3::Zero();
  const Vec3 squares = lattice.spacing_m.cwiseProduct(lattice.spacing_m);
  const auto left = [&](double variance, double curvature_times_r) {  // of the radius
    const double r = command.radius_m - surfaceDepth(fadeOf(command, strokes), bandOf(lattice.spacing_m), variance);
    return r > 0 ? std::max(r - curvature_times_r * variance / (2 * r), 0.0) : 0.0;
  };
  const double ball = left(squares.sum() / 18, 2);
  const double cylinder = left(squares.dot(Vec3::Ones() - t.cwiseProduct(t)) / 12, 1);
  const auto volume = [length](double ball_r, double cylinder_r) {  // over pi
    return 4.0 / 3 * ball_r * ball_r * ball_r + length * cylinder_r * cylinder_r;
  };
  const double whole = surfaceRadius(command, lattice, strokes);
  return 1 - volume(ball, cylinder) / volume(whole, whole);
}

std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice, Strokes strokes) {
  if (!isBrush(command.kind)) return "";
  const bool has_ramp = makesSurface(command.kind) && !(command.falloff > 0);
  const double voxel_m = lattice.smallestSpacing();
  if (command.radius_m < voxel_m / 2) {
    return fmt::format(
        "its radius of {:g} mm is below half a voxel (of {:g} mm), which voxels cannot show: "
        "densities change up to {:g} mm around it, but the surface there may hardly move; "
        "give a larger one, or resample the volume",
        command.radius_m * kMillimetresPerMetre, voxel_m * kMillimetresPerMetre,
        (command.radius_m + (has_ramp ? bandOf(lattice.spacing_m) : 0)) * kMillimetresPerMetre);
  }
  const double shortfall = brushShortfall(command, lattice, strokes);
  if (!makesSurface(command.kind) || shortfall < kToldShortfall) return "";
  const double radius_m = surfaceRadius(command, lattice, strokes);
  const Vec3 voxels = radius_m * lattice.spacing_m.cwiseInverse();
  const bool fades = radius_m < command.radius_m;
  const std::string size = fmt::format("{:.3g} mm is {:.2g} x {:.2g} x {:.2g} voxels", radius_m * kMillimetresPerMetre,
                                       voxels.x(), voxels.y(), voxels.z());
  const std::string which =
      fades ? fmt::format("with its falloff of {:g} one stroke puts the surface at a smaller radius than {:g} mm: {}",
                          command.falloff, command.radius_m * kMillimetresPerMetre, size)
            : fmt::format("its radius of {}", size);
  return fmt::format(
      "{}; of that volume it {} some {:.0f} % at most, since the surface between voxels is flatter than the brush; "
      "give a larger radius{}, or resample the volume",
      which, command.kind == EditKind::kAdd ? "adds" : "removes", 100 * (1 - shortfall),
      fades ? " or a smaller falloff" : "");
}

}  // namespace palpate
