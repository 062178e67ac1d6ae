// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/contact_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "apps/bench/random.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

constexpr double kApproachVoxels = 2;
constexpr double kOnLevelVoxels = 1e-6;  // how near to the level set a point must be [voxel]
constexpr int kNewtonSteps = 25;
constexpr int kStartTries = 10000;
constexpr int kHeadingTries = 64;
constexpr double kMostTurn_rad_per_s = 8;     // at 0.1 m/s: circles of 12 mm radius or more
constexpr double kTurnStep_rad_per_s = 0.25;  // change of the turning rate from tick to tick

struct PathPlace {
  Vec3 p_W;
  SurfaceOffset offset;
};

class Wanderer {
 public:
  Wanderer(const Phantom& phantom, const ContactPathRequest& request)
      : phantom_(phantom),
        request_(request),
        random_(request.seed),
        voxel_m_(phantom.lattice().smallestSpacing()),
        depth_m_(request.depth_voxel * voxel_m_) {}

  ContactPath path() {
    const PathPlace start = findStart();
    approach(start);
    PathPlace at = start;
    Vec3 heading_W = anyTangent(at.offset.normal);
    for (path_.slide_begin = path_.ticks(); path_.ticks() < request_.ticks;) {
      add(at);
      at = next(at, heading_W);
    }
    path_.velocity_W.assign(path_.ticks(), Vec3::Zero());
    for (std::size_t k = 1; k < path_.ticks(); ++k) {
      path_.velocity_W[k] = (path_.hip_W[k] - path_.hip_W[k - 1]) * request_.rate_hz;
    }
    return std::move(path_);
  }

 private:
  [[nodiscard]] double step_m() const { return request_.speed_m_per_s / request_.rate_hz; }
  [[nodiscard]] PathPlace placeAt(const Vec3& p_W) const { return {p_W, phantom_.offset(p_W)}; }

  [[nodiscard]] Vec3 anyTangent(const Vec3& normal_W) {
    Vec3 tangent_W = Vec3::Zero();
    while (tangent_W.norm() < 0.1) {
      const Vec3 any_W = random_.direction();
      tangent_W = any_W - normal_W * normal_W.dot(any_W);
    }
    return tangent_W.normalized();
  }

  // Newton's method for signed distance = -depth.
  [[nodiscard]] std::optional<PathPlace> ontoLevel(Vec3 p_W) const {
    for (int step = 0; step < kNewtonSteps; ++step) {
      const PathPlace at = placeAt(p_W);
      if (std::abs(at.offset.distance_m + depth_m_) <= kOnLevelVoxels * voxel_m_) return at;
      p_W -= (at.offset.distance_m + depth_m_) * at.offset.normal;
    }
    return std::nullopt;
  }

  // A point on the level set with free space in front of it.
  [[nodiscard]] PathPlace findStart() {
    const Lattice& lattice = phantom_.lattice();
    const Vec3 last_L = (phantom_.size() - Vec3i::Ones()).cast<double>();
    for (int attempt = 0; attempt < kStartTries; ++attempt) {
      Vec3 p_L;
      for (int axis = 0; axis < 3; ++axis) p_L[axis] = random_.uniform(kBorderVoxels, last_L[axis] - kBorderVoxels);
      const auto at = ontoLevel(lattice.toWorld(p_L));
      if (!at || borderDistance(phantom_, at->p_W) < kBorderVoxels) continue;
      const double air_m = kApproachVoxels * voxel_m_;
      const Vec3 front_W = at->p_W + (depth_m_ + air_m) * at->offset.normal;
      if (std::abs(phantom_.signedDistance_m(front_W) - air_m) < 1e-3 * voxel_m_) return *at;
    }
    throw Error(Error::Code::kBadInput, phantom_.spec().text, "no place of its surface can be pressed",
                "use a phantom whose surface lies inside its volume");
  }

  void approach(const PathPlace& start) {
    const double way_m = depth_m_ + kApproachVoxels * voxel_m_;
    const int steps = static_cast<int>(std::ceil(way_m / step_m()));
    for (int i = 0; i < steps; ++i)
      add(placeAt(start.p_W + way_m * (1 - i / static_cast<double>(steps)) * start.offset.normal));
  }

  void add(const PathPlace& at) {
    const Vec3 surface_W = at.p_W - at.offset.distance_m * at.offset.normal;
    path_.hip_W.push_back(at.p_W);
    path_.normal_W.push_back(at.offset.normal);
    path_.depth_m.push_back(-at.offset.distance_m);
    path_.exact.push_back(std::abs(phantom_.signedDistance_m(surface_W)) < 1e-6 * voxel_m_ ? 1 : 0);
  }

  PathPlace next(const PathPlace& at, Vec3& heading_W) {
    turn_rad_per_s_ = std::clamp(turn_rad_per_s_ + random_.uniform(-kTurnStep_rad_per_s, kTurnStep_rad_per_s),
                                 -kMostTurn_rad_per_s, kMostTurn_rad_per_s);
    const Vec3& normal_W = at.offset.normal;
    Vec3 wanted_W = Eigen::AngleAxisd(turn_rad_per_s_ / request_.rate_hz, normal_W) * heading_W;
    for (int attempt = 0; attempt < kHeadingTries; ++attempt) {
      const auto there = ontoLevel(at.p_W + step_m() * wanted_W);
      // A jump to another part of the object would not be a hand's motion.
      if (there && (there->p_W - at.p_W).norm() < 1.5 * step_m() &&
          borderDistance(phantom_, there->p_W) >= kBorderVoxels) {
        const Vec3& n_W = there->offset.normal;
        const Vec3 turned_W = wanted_W - n_W * n_W.dot(wanted_W);
        heading_W = turned_W.norm() > 1e-3 ? Vec3(turned_W.normalized()) : anyTangent(n_W);
        return *there;
      }
      wanted_W = anyTangent(normal_W);
    }
    return at;  // rests for a tick
  }

  const Phantom& phantom_;
  ContactPathRequest request_;
  Random random_;
  double voxel_m_;
  double depth_m_;
  double turn_rad_per_s_ = 0;
  ContactPath path_;
};

}  // namespace

ContactPath contactPath(const Phantom& phantom, const ContactPathRequest& request) {
  return Wanderer(phantom, request).path();
}

}  // namespace palpate
