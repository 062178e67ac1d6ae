// SPDX-License-Identifier: Apache-2.0
#include "apps/path/start_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr double kStartReachVoxels = 20;   // a wished start may be this far from the surface
constexpr double kStartReach_m = 20.0e-3;  // or this far, whichever is more
constexpr double kRingVoxels = 3;          // radius of the surroundings whose normals are compared
constexpr int kRingPoints = 8;
constexpr double kClearlyBetter = 0.01;  // of score, so that rounding does not choose between equal places

struct Ray {
  Vec3 origin_W, direction_W;
  double reach_m;
};

Vec3 middle(const SurfaceField& field) {
  return field.lattice().toWorld((field.size().cast<double>() - Vec3::Ones()) / 2);
}

double diagonal(const SurfaceField& field) {
  return field.size().cast<double>().cwiseProduct(field.lattice().spacing_m).norm();
}

// The axes and corners of the world, most natural first: from above, from the front, from the sides.
std::vector<Vec3> naturalDirections() {
  std::vector<Vec3> all = {-Vec3::UnitZ(), Vec3::UnitY(), Vec3::UnitX(), -Vec3::UnitX(), -Vec3::UnitY(), Vec3::UnitZ()};
  for (int i = 0; i < 8; ++i) {
    all.push_back(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).normalized());
  }
  return all;
}

// Parallel rays through the middle and through a square grid around it, nearest to the middle first.
void addRays(const SurfaceField& field, const Vec3& direction_W, int rings, std::vector<Ray>& rays) {
  const Vec3 side_W = direction_W.unitOrthogonal(), other_W = direction_W.cross(side_W);
  const double reach_m = diagonal(field), step_m = 0.35 * reach_m / 2 / rings;
  for (int ring = 0; ring <= rings; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      for (int j = -ring; j <= ring; ++j) {
        if (std::max(std::abs(i), std::abs(j)) != ring) continue;
        const Vec3 through_W = middle(field) + step_m * (i * side_W + j * other_W);
        rays.push_back({through_W - reach_m / 2 * direction_W, direction_W, reach_m});
      }
    }
  }
}

std::vector<Ray> raysFor(const SurfaceField& field, const PathRequest& request) {
  std::vector<Ray> rays;
  if (request.toward_W) {
    addRays(field, request.toward_W->normalized(), 3, rays);
  } else {
    for (const Vec3& direction_W : naturalDirections()) addRays(field, direction_W, 1, rays);
  }
  return rays;
}

// Mean cosine between the normal at a point and those around it: 1 on a plane, less on edges, ridges and noise.
double calmness(const SurfaceField& field, const SurfaceHit& at) {
  const Vec3 u_W = at.normal_W.unitOrthogonal(), v_W = at.normal_W.cross(u_W);
  const double radius_m = kRingVoxels * field.lattice().smallestSpacing();
  double sum = 0;
  for (int i = 0; i < kRingPoints; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRingPoints;
    const auto near = snapToSurface(field, at.p_W + radius_m * (std::cos(angle) * u_W + std::sin(angle) * v_W));
    if (near) sum += near->normal_W.dot(at.normal_W);
  }
  return sum / kRingPoints;
}

// A calm place that faces the tool and leaves it room to come from. Above 1 is ideal, below 0 useless.
double score(const SurfaceField& field, const SurfaceHit& at, const Vec3& direction_W, double approach_m) {
  const double facing = -direction_W.dot(at.normal_W);
  const double room = freeDistance(field, at, at.normal_W, approach_m) / approach_m;
  return calmness(field, at) + 0.2 * facing + 0.5 * (room - 1);
}

SurfaceHit startNear(const SurfaceField& field, const Vec3& start_W) {
  // No farther than the volume is long: a search by voxels of a micrometre would never end.
  const double reach_m =
      std::min(std::max(kStartReach_m, kStartReachVoxels * field.lattice().smallestSpacing()), diagonal(field));
  if (const auto point = nearestSurfacePoint(field, start_W, reach_m)) return *point;
  const Vec3 start_mm = start_W * kMillimetresPerMetre;
  throw Error(Error::Code::kBadInput, "path start",
              fmt::format("no surface at isovalue {:g} within {:g} mm of ({:g}, {:g}, {:g}) mm", field.isovalue(),
                          reach_m * kMillimetresPerMetre, start_mm.x(), start_mm.y(), start_mm.z()),
              "give a point nearer to the surface or another isovalue");
}

}  // namespace

SurfaceHit chooseStart(const SurfaceField& field, const PathRequest& request) {
  if (request.start_W) return startNear(field, *request.start_W);
  std::optional<SurfaceHit> best;
  double best_score = 0;
  for (const Ray& ray : raysFor(field, request)) {
    const auto point = firstEntry(field, ray.origin_W, ray.direction_W, ray.reach_m);
    if (!point || point->normal_W.dot(ray.direction_W) >= 0) continue;
    const double now = score(field, *point, ray.direction_W, request.approach_m);
    if (best && now <= best_score + kClearlyBetter) continue;
    best = point;
    best_score = now;
  }
  if (best) return *best;
  throw Error(Error::Code::kBadInput, "path",
              fmt::format("no ray into the volume meets a surface at isovalue {:g}", field.isovalue()),
              "the isovalue may be wrong: choose another, or give a path start near the surface");
}

}  // namespace palpate
