// SPDX-License-Identifier: Apache-2.0
#include "apps/path/surface_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate {
namespace {

constexpr int kBisections = 20;       // half a voxel / 2^20 is below 1e-6 voxel
constexpr double kSnapVoxels = 1e-4;  // Newton's method stops this near to the surface
constexpr int kNearestDirections = 600;

double voxel(const SurfaceField& field) {
  return field.lattice().smallestSpacing();
}

// Both ends are known, `out_W` in background and `in_W` in the object: halves the way between until it has no length.
Vec3 bisect(const SurfaceField& field, Vec3 out_W, Vec3 in_W) {
  for (int i = 0; i < kBisections; ++i) {
    const Vec3 middle_W = 0.5 * (out_W + in_W);
    (heightAt(field, middle_W).value_or(0) > 0 ? in_W : out_W) = middle_W;
  }
  return out_W;
}

std::optional<SurfaceHit> withNormal(const SurfaceField& field, const Vec3& p_W) {
  const auto normal_W = normalAt(field, p_W);
  if (!normal_W) return std::nullopt;
  return SurfaceHit{p_W, *normal_W};
}

// Evenly spread unit directions (Fibonacci lattice), so that the search is the same on every machine.
Vec3 spreadDirection(int i, int count) {
  const double z = 1 - (2.0 * i + 1) / count, radius = std::sqrt(1 - z * z);
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
  return {radius * std::cos(turn), radius * std::sin(turn), z};
}

// The part of a ray, as distances from its origin, that lies in the volume: nothing is known beyond, and a reach in
// millimetres may be many volumes long. Half a step more on either side, for rounding. Empty (begin > end): none.
struct Stretch {
  double begin_m, end_m;
};

Stretch insideVolume(const SurfaceField& field, const Vec3& origin_W, const Vec3& direction_W, double reach_m) {
  const Vec3 from_L = field.lattice().toIndex(origin_W);
  const Vec3 along_L = field.lattice().toIndex(origin_W + voxel(field) * direction_W) - from_L;  // of one voxel's way
  const Vec3 last_L = field.size().cast<double>().array() - 1;
  double begin = -std::numeric_limits<double>::infinity(), end = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(along_L[i]) < 1e-12) {
      if (from_L[i] < -1e-6 || from_L[i] > last_L[i] + 1e-6) return {1, 0};
      continue;
    }
    const double a = -from_L[i] / along_L[i], b = (last_L[i] - from_L[i]) / along_L[i];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return {std::max(0.0, (begin - 0.5) * voxel(field)), std::min(reach_m, (end + 0.5) * voxel(field))};
}

// Where the side changes first along a ray, in either sense, as a distance from its origin [m].
std::optional<double> firstChange(const SurfaceField& field, const Vec3& origin_W, const Vec3& direction_W,
                                  double reach_m) {
  const double step_m = 0.5 * voxel(field);
  const Stretch inside = insideVolume(field, origin_W, direction_W, reach_m);
  const double first = std::floor(inside.begin_m / step_m);
  auto before = heightAt(field, origin_W + first * step_m * direction_W);
  for (double n = first + 1; n * step_m <= inside.end_m; ++n) {
    const double s = n * step_m;
    const auto now = heightAt(field, origin_W + s * direction_W);
    if (before && now && (*before > 0) != (*now > 0)) return s;
    before = now;
  }
  return std::nullopt;
}

}  // namespace

std::optional<double> heightAt(const SurfaceField& field, const Vec3& p_W) {
  const std::optional<double> density = field.density(p_W);
  if (!density) return std::nullopt;
  return *density - field.isovalue();
}

std::optional<Vec3> normalAt(const SurfaceField& field, const Vec3& p_W) {
  double density = 0;
  Vec3 gradient_W;
  if (!field.sample(p_W, density, gradient_W)) return std::nullopt;
  const double norm = gradient_W.norm();
  if (!(norm > 0)) return std::nullopt;
  return -gradient_W / norm;
}

std::optional<SurfaceHit> firstEntry(const SurfaceField& field, const Vec3& origin_W, const Vec3& direction_W,
                                     double reach_m) {
  const double step_m = 0.5 * voxel(field);
  const Stretch inside = insideVolume(field, origin_W, direction_W, reach_m);
  bool outside_before = false;  // beyond the volume nothing is known: where it cuts the object there is no surface
  for (double i = std::floor(inside.begin_m / step_m); i <= std::ceil(inside.end_m / step_m); ++i) {
    const Vec3 p_W = origin_W + std::min(i * step_m, reach_m) * direction_W;
    const auto height = heightAt(field, p_W);
    if (height && *height > 0 && outside_before) {
      return withNormal(field, bisect(field, p_W - step_m * direction_W, p_W));
    }
    outside_before = height && *height <= 0;
  }
  return std::nullopt;
}

double freeDistance(const SurfaceField& field, const SurfaceHit& from, const Vec3& direction_W, double reach_m) {
  const double step_m = 0.5 * voxel(field);
  const double end_m = insideVolume(field, from.p_W, direction_W, reach_m).end_m;
  for (double s = step_m; s < end_m; s += step_m) {
    if (heightAt(field, from.p_W + s * direction_W).value_or(0) > 0) return s - step_m;
  }
  return reach_m;
}

std::optional<SurfaceHit> snapToSurface(const SurfaceField& field, const Vec3& near_W) {
  const double h_m = voxel(field);
  Vec3 p_W = near_W;
  for (int i = 0; i < 60; ++i) {
    double density = 0;
    Vec3 gradient_W;
    if (!field.sample(p_W, density, gradient_W) || !(gradient_W.squaredNorm() > 0)) return std::nullopt;
    Vec3 step_W = (field.isovalue() - density) / gradient_W.squaredNorm() * gradient_W;
    if (step_W.norm() < kSnapVoxels * h_m) return withNormal(field, p_W);
    if (step_W.norm() > 0.5 * h_m) step_W *= 0.5 * h_m / step_W.norm();
    p_W += step_W;
  }
  return std::nullopt;
}

std::optional<SurfaceHit> nearestSurfacePoint(const SurfaceField& field, const Vec3& p_W, double reach_m) {
  double best_m = reach_m;
  std::optional<SurfaceHit> best;
  for (int i = 0; i < kNearestDirections; ++i) {
    const Vec3 direction_W = spreadDirection(i, kNearestDirections);
    const auto distance_m = firstChange(field, p_W, direction_W, best_m);
    if (!distance_m) continue;
    const auto point = snapToSurface(field, p_W + *distance_m * direction_W);
    if (!point || (best && (point->p_W - p_W).norm() >= (best->p_W - p_W).norm())) continue;
    best = point;
    best_m = std::min(best_m, *distance_m);
  }
  // At the foot point the line to p is along the normal, so move along the line's part in the tangent plane.
  for (int i = 0; best && i < 20; ++i) {
    const Vec3 away_W = p_W - best->p_W;
    const Vec3 along_W = away_W - away_W.dot(best->normal_W) * best->normal_W;
    const auto next = snapToSurface(field, best->p_W + 0.7 * along_W);
    if (!next || (next->p_W - p_W).norm() >= away_W.norm()) break;
    best = next;
  }
  return best;
}

}  // namespace palpate
