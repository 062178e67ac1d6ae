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
constexpr std::size_t kSampleRays = 64;
constexpr double kPastEntryVoxels = 0.01;  // beyond an entry the search goes on
constexpr double kClearlyBetter = 0.01;    // of score, so that rounding does not choose between equal places

struct Ray {
  Vec3 origin_W, direction_W;
  double reach_m;
};

// The target of the rays: the box around a piece.
struct Target {
  Vec3 middle_W;
  double diagonal_m;
};

Target targetOf(const SurfaceField& field, const ObjectPiece& piece) {
  return {field.lattice().toWorld((piece.first + piece.last).cast<double>() / 2),
          (piece.last - piece.first + Vec3i::Ones()).cast<double>().cwiseProduct(field.lattice().spacing_m).norm()};
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
void addRays(const SurfaceField& field, const Target& target, const Vec3& direction_W, int rings,
             std::vector<Ray>& rays) {
  const Vec3 side_W = direction_W.unitOrthogonal(), other_W = direction_W.cross(side_W);
  const double step_m = 0.35 * target.diagonal_m / 2 / rings;
  const double reach_m = target.diagonal_m + 2 * field.lattice().spacing_m.maxCoeff();
  for (int ring = 0; ring <= rings; ++ring) {
    for (int i = -ring; i <= ring; ++i) {
      for (int j = -ring; j <= ring; ++j) {
        if (std::max(std::abs(i), std::abs(j)) != ring) continue;
        const Vec3 through_W = target.middle_W + step_m * (i * side_W + j * other_W);
        rays.push_back({through_W - reach_m / 2 * direction_W, direction_W, reach_m});
      }
    }
  }
}

std::vector<Ray> raysFor(const SurfaceField& field, const Target& target, const std::optional<Vec3>& toward_W) {
  std::vector<Ray> rays;
  if (toward_W) {
    addRays(field, target, toward_W->normalized(), 3, rays);
  } else {
    for (const Vec3& direction_W : naturalDirections()) addRays(field, target, direction_W, 1, rays);
  }
  return rays;
}

// Short rays from neighbours of the piece's samples, for a thin or curled piece that no ray of the grid meets.
std::vector<Ray> raysAtSamples(const SurfaceField& field, const ObjectPieces& pieces, std::size_t piece) {
  std::vector<Ray> rays;
  for (const ObjectPieces::Entry& entry : pieces.entries(piece, kSampleRays)) {
    const Vec3 from_W = field.lattice().toWorld(entry.outside.cast<double>());
    const Vec3 to_W = field.lattice().toWorld((entry.outside + entry.sense * Vec3i::UnitX()).cast<double>());
    rays.push_back({from_W, (to_W - from_W).normalized(), (to_W - from_W).norm()});
  }
  return rays;
}

// Where a ray first enters this piece. It passes through other pieces in front of it.
std::optional<SurfaceHit> firstEntryInto(const SurfaceField& field, const ObjectPieces& pieces, std::size_t piece,
                                         const Ray& ray) {
  Vec3 from_W = ray.origin_W;
  for (double left_m = ray.reach_m; left_m > 0;) {
    auto point = firstEntry(field, from_W, ray.direction_W, left_m);
    if (!point || pieces.pieceAt(point->p_W) == piece) return point;
    const double way_m =
        (point->p_W - from_W).dot(ray.direction_W) + kPastEntryVoxels * field.lattice().smallestSpacing();
    from_W += way_m * ray.direction_W;
    left_m -= way_m;
  }
  return std::nullopt;
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

// Rates a place: high if the normals vary little, it faces the tool and there is room. Above 1 is ideal, below 0
// useless.
double score(const SurfaceField& field, const SurfaceHit& at, const Vec3& direction_W, double approach_m) {
  const double facing = -direction_W.dot(at.normal_W);
  const double room = freeDistance(field, at, at.normal_W, approach_m) / approach_m;
  return calmness(field, at) + 0.2 * facing + 0.5 * (room - 1);
}

std::optional<SurfaceHit> bestOf(const SurfaceField& field, const ObjectPieces& pieces, std::size_t piece,
                                 const std::vector<Ray>& rays, double approach_m) {
  std::optional<SurfaceHit> best;
  double best_score = 0;
  for (const Ray& ray : rays) {
    const auto point = firstEntryInto(field, pieces, piece, ray);
    if (!point || point->normal_W.dot(ray.direction_W) >= 0) continue;
    const double now = score(field, *point, ray.direction_W, approach_m);
    if (best && now <= best_score + kClearlyBetter) continue;
    best = point;
    best_score = now;
  }
  return best;
}

}  // namespace

SurfaceHit startNear(const SurfaceField& field, const Vec3& start_W) {
  // At most the volume's length: with voxels of a micrometre the search would otherwise never end.
  const double longest_m = field.size().cast<double>().cwiseProduct(field.lattice().spacing_m).norm();
  const double reach_m =
      std::min(std::max(kStartReach_m, kStartReachVoxels * field.lattice().smallestSpacing()), longest_m);
  if (const auto point = nearestSurfacePoint(field, start_W, reach_m)) return *point;
  const Vec3 start_mm = start_W * kMillimetresPerMetre;
  throw Error(Error::Code::kBadInput, "path start",
              fmt::format("no surface at isovalue {:g} within {:g} mm of ({:g}, {:g}, {:g}) mm", field.isovalue(),
                          reach_m * kMillimetresPerMetre, start_mm.x(), start_mm.y(), start_mm.z()),
              "give a point nearer to the surface or another isovalue");
}

std::optional<SurfaceHit> startOn(const SurfaceField& field, const ObjectPieces& pieces, std::size_t piece,
                                  const std::optional<Vec3>& toward_W, double approach_m) {
  const Target target = targetOf(field, pieces.all()[piece]);
  if (auto best = bestOf(field, pieces, piece, raysFor(field, target, toward_W), approach_m)) return best;
  // From the wished direction there is nothing to be met, and no other was asked for.
  if (toward_W) return std::nullopt;
  return bestOf(field, pieces, piece, raysAtSamples(field, pieces, piece), approach_m);
}

}  // namespace palpate
