// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/strokes.hpp"

#include <cmath>
#include <numbers>

#include "apps/bench/random.hpp"
#include "apps/sampled/window_follower.hpp"
#include "base/units.hpp"
#include "servo/window/window_sampler.hpp"

namespace palpate {
namespace {

constexpr double kRunUp_voxel = 5;
constexpr double kLookAlong_voxel = 0.1;
constexpr double kLookAcross_voxel = 0.02;

// p(s) = meets + s * direction: s < 0 in free space [m].
struct Stroke {
  Vec3 meets_W = Vec3::Zero();
  Vec3 direction_W = Vec3::Zero();
  Vec3 normal_W = Vec3::Zero();  // of the surface at meets_W
  double phase = 0;              // offset of the first tick, as a fraction of a step
};

class Strokes {
 public:
  Strokes(const BenchVolume& volume, const StrokeRequest& request)
      : volume_(volume), request_(request), random_(request.seed), whole_(volume.whole()), sampler_(whole_) {}

  [[nodiscard]] double way_m() const { return kBenchForceLimit_N / kBenchStiffness_N_per_m; }

  // A random stroke. In front of the surface it is in free space, and it begins within the volume.
  [[nodiscard]] Stroke any() {
    while (true) {
      Stroke stroke;
      const auto at = surfacePoint();
      if (!at) continue;
      stroke.meets_W = *at;
      stroke.normal_W = volume_.phantom().normal(*at);
      stroke.direction_W = inward(stroke.normal_W);
      stroke.phase = random_.uniform();
      const double run_up_m = kRunUp_voxel * volume_.voxel_m();
      bool free = true;
      for (double s = -run_up_m; s < -0.5 * volume_.voxel_m(); s += 0.5 * volume_.voxel_m()) {
        free = free && volume_.phantom().signedDistance_m(stroke.meets_W + s * stroke.direction_W) > 0;
      }
      const Vec3 from_W = stroke.meets_W - run_up_m * stroke.direction_W;
      if (free && volume_.borderDistance(from_W) >= 1) return stroke;
    }
  }

  // Whether the samples have a wall everywhere along the ideal contact point's way.
  [[nodiscard]] bool hasWall(const Stroke& stroke) const {
    if (!request_.thin_wall) return true;
    const double radius_m = stroke.meets_W.norm();
    for (double s = 0; s <= way_m(); s += kLookAlong_voxel * volume_.voxel_m()) {
      const Vec3 hip_W = stroke.meets_W + s * stroke.direction_W;
      if (!wallAcross(hip_W.normalized(), radius_m)) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] std::optional<Vec3> surfacePoint() {
    const Vec3 last_L = (volume_.size() - Vec3i::Ones()).cast<double>();
    Vec3 p_L;
    for (int axis = 0; axis < 3; ++axis) p_L[axis] = random_.uniform(0, last_L[axis]);
    Vec3 p_W = volume_.phantom().lattice().toWorld(p_L);
    // Outside only: from inside a thin wall the nearest surface may be its back.
    if (volume_.phantom().signedDistance_m(p_W) <= 0 || behindWall(p_W)) return std::nullopt;
    for (int step = 0; step < 30; ++step) {
      const SurfaceOffset offset = volume_.phantom().offset(p_W);
      if (std::abs(offset.distance_m) < 1e-9 * volume_.voxel_m()) return p_W;
      p_W -= offset.distance_m * offset.normal;
    }
    return std::nullopt;
  }

  // Whether a point is in the shell's hollow. There the run-up has no room, and a stroke would leave the volume.
  [[nodiscard]] bool behindWall(const Vec3& p_W) const {
    return request_.thin_wall && volume_.phantom().normal(p_W).dot(p_W) < 0;
  }

  [[nodiscard]] Vec3 inward(const Vec3& normal_W) {
    Vec3 aside_W = random_.direction();
    aside_W -= normal_W * normal_W.dot(aside_W);
    if (aside_W.norm() < 1e-3) return -normal_W;
    const double angle = random_.uniform(0, request_.most_incidence_deg) / kDegreesPerRadian;
    return -std::cos(angle) * normal_W + std::sin(angle) * aside_W.normalized();
  }

  [[nodiscard]] bool wallAcross(const Vec3& outward_W, double radius_m) const {
    const double voxel_m = volume_.voxel_m();
    for (double r = radius_m + voxel_m; r > radius_m - 3 * voxel_m; r -= kLookAcross_voxel * voxel_m) {
      if (sampler_.at(r * outward_W).density > volume_.isovalue()) return true;
    }
    return false;
  }

  const BenchVolume& volume_;
  StrokeRequest request_;
  Random random_;
  SampleWindow whole_;
  WindowSampler sampler_;
};

struct Seen {
  TickOutput out;     // of the last tick
  bool had = false;   // there was contact
  bool lost = false;  // there was contact, and later a tick without it
};

// The depth below the surface at `s_m` along the stroke. In a thin wall it is measured on past the inner face: below
// the tangent plane of the outer face.
double depthAt(const BenchVolume& volume, const Stroke& stroke, bool thin_wall, double s_m) {
  if (!thin_wall) return -volume.phantom().signedDistance_m(stroke.meets_W + s_m * stroke.direction_W);
  return -s_m * stroke.direction_W.dot(stroke.normal_W);
}

void runStroke(const BenchVolume& volume, const Stroke& stroke, double speed_m_per_s, double way_m, bool thin_wall,
               std::span<Entrant> entrants, std::vector<Seen>& seen) {
  const double step_m = speed_m_per_s / kBenchRate_hz;
  const double begin_m = -kRunUp_voxel * volume.voxel_m() + stroke.phase * step_m;
  std::vector<WindowFollower> followers;
  for (std::size_t e = 0; e < entrants.size(); ++e) followers.emplace_back(volume);
  seen.assign(entrants.size(), Seen{});
  const Vec3 velocity_W = speed_m_per_s * stroke.direction_W;
  double deepest_m = 0;
  for (Entrant& entrant : entrants) entrant.haptic->reset(stroke.meets_W + begin_m * stroke.direction_W);
  for (std::int64_t k = 0;; ++k) {
    const double s_m = begin_m + static_cast<double>(k) * step_m;
    if (s_m >= way_m) return;
    const double depth_m = depthAt(volume, stroke, thin_wall, s_m);
    if (s_m > 0 && depth_m < deepest_m) return;  // past the middle
    deepest_m = std::max(deepest_m, depth_m);
    const Vec3 hip_W = stroke.meets_W + s_m * stroke.direction_W;
    if (volume.borderDistance(hip_W) < 1) return;
    for (std::size_t e = 0; e < entrants.size(); ++e) {
      TickOutput& out = seen[e].out;
      const SampleWindow& window = followers[e].around(windowPlace(out, hip_W));
      entrants[e].haptic->tick({hip_W, velocity_W, &window}, out);
      const bool contact = hasContact(out);
      seen[e].lost = seen[e].lost || (seen[e].had && !contact);
      seen[e].had = seen[e].had || contact;
    }
  }
}

}  // namespace

std::vector<std::vector<StrokeFigures>> strokeFigures(const BenchVolume& volume, const StrokeRequest& request,
                                                      std::span<Entrant> entrants, const BenchProgress& progress) {
  std::vector<std::vector<StrokeFigures>> figures(entrants.size());
  Strokes strokes(volume, request);
  const double total = static_cast<double>(request.speeds_m_per_s.size()) * request.strokes;
  double done = 0;
  std::vector<Seen> seen;
  for (const double speed : request.speeds_m_per_s) {
    for (auto& of_entrant : figures) of_entrant.push_back({.speed_m_per_s = speed});
    for (int i = 0; i < request.strokes; ++i) {
      progress(done++ / total);
      const Stroke stroke = strokes.any();
      const bool wall = strokes.hasWall(stroke);
      if (wall) runStroke(volume, stroke, speed, strokes.way_m(), request.thin_wall, entrants, seen);
      for (std::size_t e = 0; e < entrants.size(); ++e) {
        StrokeFigures& f = figures[e].back();
        f.over_hole += wall ? 0 : 1;
        if (!wall) continue;
        ++f.strokes;
        f.missed += seen[e].had ? 0 : 1;
        f.lost += seen[e].lost ? 1 : 0;
      }
    }
  }
  return figures;
}

}  // namespace palpate
