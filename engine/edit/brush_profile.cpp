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

// What a surface's density is made of, under the rim of a brush at u = 0.
enum class Rim {
  kRamp,  // without a falloff: the ramp goes on beyond the rim
  kFade,  // one stroke with a falloff
  kStep   // many of them: all that is within the rim has reached the ramp, and nothing beyond it changes
};

Rim rimOf(const EditCommand& command, Strokes strokes) {
  if (!makesSurface(command.kind) || !(command.falloff > 0)) return Rim::kRamp;
  return strokes == Strokes::kOne ? Rim::kFade : Rim::kStep;
}

// How far under the rim the surface lies [m], where all is level and voxels blur the density.
//
// A point at a random place between voxels has the mean of the density around it, weighted by a hat as wide as a voxel
// to either side of it along each axis: by trilinear interpolation. That hat's variance is h^2 / 6. Along a normal n it
// is the sum of n_i^2 h_i^2 / 6, which is sum h^2 / 18 on average over a ball, and sum (1 - t_i^2) h_i^2 / 12 over a
// cylinder along t. Here the weights are a hat with that variance; 0: no blur.
double levelDepth(Rim rim, double fade_m, double band_m, double variance_m2) {
  if (rim == Rim::kRamp) return 0;  // it is as long on either side
  // Above the isovalue, in units of the contrast, which is taken to be the same on both sides.
  const auto density = [&](double u) {
    const double s = rim == Rim::kStep ? (u > 0 ? 1.0 : 0.0) : std::clamp(u / fade_m, 0.0, 1.0);
    const double w = s * s * (3 - 2 * s);
    return 1 - w - w * std::min(u / band_m, 1.0);
  };
  const double half_m = std::sqrt(6 * variance_m2);
  const int parts = half_m > 0 ? 48 : 1;  // a step in the density is then placed to 1 / 24 of the hat's half
  const auto blurred = [&](double u) {
    double sum = 0;
    for (int n = 0; n < parts; ++n) {
      const double x = (2.0 * n + 1) / parts - 1;
      sum += (1 - std::abs(x)) * density(u + half_m * x);
    }
    return sum;
  };
  double low = 0, high = fade_m + half_m;
  for (int n = 0; n < 30; ++n) {  // to a billionth
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
  const double fade_m = command.falloff * command.radius_m;
  return command.radius_m - levelDepth(rimOf(command, strokes), fade_m, bandOf(lattice.spacing_m), 0);
}

double brushShortfall(const EditCommand& command, const Lattice& lattice, Strokes strokes) {
  const Vec3 along = lattice.R_WL.transpose() * (command.to_W - command.from_W);
  const double length = along.norm();
  const Vec3 t = length > 0 ? Vec3(along / length) : Vec3::Zero();
  const Vec3 squares = lattice.spacing_m.cwiseProduct(lattice.spacing_m);
  const Rim rim = rimOf(command, strokes);
  // What is left of the radius. Where the surface is curved, a blur takes half of its variance times the curvature
  // more: 2 / r on a ball, 1 / r on a cylinder.
  const auto left = [&](double variance_m2, double curvature_times_r) {
    const double r =
        command.radius_m - levelDepth(rim, command.falloff * command.radius_m, bandOf(lattice.spacing_m), variance_m2);
    return r > 0 ? std::max(r - variance_m2 / 2 * curvature_times_r / r, 0.0) : 0.0;
  };
  const double ball = left(squares.sum() / 18, 2);
  const double cylinder = length > 0 ? left(squares.dot(Vec3::Ones() - t.cwiseProduct(t)) / 12, 1) : 0;
  const auto volume = [length](double ball_r, double cylinder_r) {  // over pi
    return 4.0 / 3 * ball_r * ball_r * ball_r + length * cylinder_r * cylinder_r;
  };
  const double whole = surfaceRadius(command, lattice, strokes);
  return 1 - volume(ball, cylinder) / volume(whole, whole);
}

std::string fineBrushWarning(const EditCommand& command, const Lattice& lattice, Strokes strokes, double told) {
  if (!isBrush(command.kind)) return "";
  const Rim rim = rimOf(command, strokes);
  const double voxel_m = lattice.smallestSpacing();
  if (command.radius_m < voxel_m / 2) {
    const double beyond_m = makesSurface(command.kind) && rim == Rim::kRamp ? bandOf(lattice.spacing_m) : 0;
    return fmt::format(
        "its radius of {:g} mm is below half a voxel (of {:g} mm), which voxels cannot show: "
        "densities change up to {:g} mm around it, but the surface there may hardly move; "
        "give a larger one, or resample the volume",
        command.radius_m * kMillimetresPerMetre, voxel_m * kMillimetresPerMetre,
        (command.radius_m + beyond_m) * kMillimetresPerMetre);
  }
  if (!makesSurface(command.kind)) return "";
  const double shortfall = brushShortfall(command, lattice, strokes);
  if (shortfall < told) return "";
  const double radius_m = surfaceRadius(command, lattice, strokes);
  const Vec3 voxels = radius_m * lattice.spacing_m.cwiseInverse();
  const std::string size = fmt::format("{:.3g} mm, {:.2g} x {:.2g} x {:.2g} voxels", radius_m * kMillimetresPerMetre,
                                       voxels.x(), voxels.y(), voxels.z());
  const char* const makes = command.kind == EditKind::kAdd ? "adds" : "removes";
  const std::string which =
      rim == Rim::kFade
          ? fmt::format(
                "one stroke with its falloff of {:g} is to have its surface at a radius of {}; of what is within,",
                command.falloff, size)
          : fmt::format("its radius is {}; of what is within,", size);
  const std::string share = voxels.minCoeff() < 0.7
                                ? fmt::format("it {} some part or nothing, as its place between voxels has it", makes)
                                : fmt::format("it {} some {:.0f} %", makes, 100 * (1 - shortfall));
  return fmt::format(
      "{} {}, since the surface between voxels is flatter than the brush; give a larger radius{}, or "
      "resample the volume",
      which, share, rim == Rim::kRamp ? "" : " or no falloff");
}

}  // namespace palpate
