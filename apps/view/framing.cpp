// SPDX-License-Identifier: Apache-2.0
#include "apps/view/framing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kFov_rad = 30 / kDegreesPerRadian;
constexpr int kGrid = 24;  // samples along an axis when the object is looked for
constexpr std::array<double, 5> kElevations_deg = {28, 42, 58, 75, 85};
constexpr int kOpenDirections = 100;
// A degree of height costs as much as this fraction of hidden points. From above no depth is visible, but a groove can
// only be seen into from above.
constexpr double kSteepnessCost = 0.01, kSteepnessCostOfCut = 0.004;
// Rays begin so far above the surface. In a groove nothing is under the points any more. [voxel]
constexpr double kAbove = 1.5, kAboveCut = 0.5;

// The distance from which a sphere fills the smaller side of the picture.
double distanceFor(double radius_m, int width, int height) {
  const double half = std::atan(std::tan(kFov_rad / 2) * std::min(1.0, static_cast<double>(width) / height));
  return radius_m / std::sin(half);
}

// Whether the object is on the way from `start_W` towards `from_W`, within the neighbourhood of the region.
bool isHidden(const SurfaceField& field, const ContactRegion& region, const Vec3& start_W, const Vec3& from_W) {
  const double h_m = field.lattice().smallestSpacing();
  for (double s = h_m; s < 4 * region.radius_m; s += h_m) {
    double density = 0;
    Vec3 gradient_W;
    if (field.sample(start_W + s * from_W, density, gradient_W) && density > field.isovalue()) return true;
  }
  return false;
}

// Share of points that the object hides: rays from just above the surface towards the camera.
double hiddenShare(const SurfaceField& field, const ContactRegion& region, const Vec3& from_W) {
  if (region.points_W.empty()) return 0;
  const Vec3 above_W = (region.is_cut ? kAboveCut : kAbove) * field.lattice().smallestSpacing() * region.normal_W;
  const auto hidden = std::count_if(region.points_W.begin(), region.points_W.end(),
                                    [&](const Vec3& p_W) { return isHidden(field, region, p_W + above_W, from_W); });
  return static_cast<double>(hidden) / static_cast<double>(region.points_W.size());
}

// The nth of `count` directions that are spread evenly over the sphere (Fibonacci's lattice).
Vec3 directionOf(int n, int count) {
  const double z = 1 - (2 * n + 1.0) / count;
  const double turn = n * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

Vec3 upFor(const Vec3& from_W) {
  return std::abs(from_W.z()) < 0.95 ? Vec3::UnitZ() : Vec3(-Vec3::UnitY());
}

}  // namespace

ObjectBounds findObjectBounds(const SurfaceField& field) {
  const Vec3 last = field.size().cast<double>() - Vec3::Ones();
  Vec3 low = last, high = Vec3::Zero();
  for (int i = 0; i < kGrid * kGrid * kGrid; ++i) {
    const Vec3i at(i % kGrid, i / kGrid % kGrid, i / kGrid / kGrid);
    const Vec3 share = at.cast<double>() / (kGrid - 1);
    const Vec3 p_L = share.cwiseProduct(last);
    double density = 0;
    Vec3 gradient_W;
    if (!field.sample(field.lattice().toWorld(p_L), density, gradient_W) || density <= field.isovalue()) continue;
    low = low.cwiseMin(p_L);
    high = high.cwiseMax(p_L);
  }
  if ((high.array() < low.array()).any()) {
    low = Vec3::Zero();
    high = last;
  }
  const Vec3 cell = last / (kGrid - 1);  // the surface may lie this much outside the outermost sample that is object
  const Vec3 half_m = ((high - low) / 2 + cell / 2).cwiseProduct(field.lattice().spacing_m);
  return {field.lattice().toWorld((low + high) / 2), half_m.norm()};
}

Camera overviewCamera(const ObjectBounds& object, const ContactRegion& region, int width, int height) {
  const Vec3 outward_W = region.centre_W - object.centre_W;
  Vec3 side_W = region.normal_W + (outward_W.norm() > 1e-9 ? outward_W.normalized() : Vec3::Zero());
  if (side_W.norm() < 1e-3) side_W = region.normal_W;
  // A quarter turn of the way around keeps the normal from pointing straight at the eye.
  const Vec3 from_W = (side_W.normalized() - 0.8 * region.normal_W.cross(region.along_W)).normalized();
  return lookAt(object.centre_W, from_W, distanceFor(object.radius_m, width, height), upFor(from_W), width, height,
                kFov_rad);
}

void turnToTheOpen(ContactRegion& region, const SurfaceField& field) {
  const double h_m = field.lattice().smallestSpacing();
  Vec3 open_W = Vec3::Zero();
  for (int n = 0; n < kOpenDirections; ++n) {
    const Vec3 direction_W = directionOf(n, kOpenDirections);
    for (const Vec3& p_W : region.points_W) {
      if (!isHidden(field, region, p_W + h_m * direction_W, direction_W)) open_W += direction_W;
    }
  }
  region.is_cut = true;
  if (open_W.norm() < 1e-9) return;
  region.normal_W = open_W.normalized();
  const Vec3 along_W = region.along_W - region.along_W.dot(region.normal_W) * region.normal_W;
  region.along_W = along_W.norm() > 1e-3 ? Vec3(along_W.normalized()) : Vec3(region.normal_W.unitOrthogonal());
}

Camera closeUpCamera(const SurfaceField& field, const ContactRegion& region, int width, int height) {
  const Vec3 side_W = region.along_W.cross(region.normal_W);
  const double steepness_cost = region.is_cut ? kSteepnessCostOfCut : kSteepnessCost;
  Vec3 best_W = region.normal_W;
  double best = 2;
  for (const double elevation_deg : kElevations_deg) {
    for (const double sign : {1.0, -1.0}) {
      const double angle = elevation_deg / kDegreesPerRadian;
      const Vec3 from_W = sign * std::cos(angle) * side_W + std::sin(angle) * region.normal_W;
      const double cost =
          hiddenShare(field, region, from_W) + steepness_cost * (elevation_deg - kElevations_deg.front());
      if (cost >= best - 0.05) continue;
      best = cost;
      best_W = from_W;
    }
  }
  // The camera looks at a point a little above the surface, which leaves room for the arrows.
  const Vec3 target_W = region.centre_W + 0.15 * region.radius_m * region.normal_W;
  return lookAt(target_W, best_W, distanceFor(region.radius_m, width, height), region.normal_W, width, height,
                kFov_rad);
}

}  // namespace palpate
