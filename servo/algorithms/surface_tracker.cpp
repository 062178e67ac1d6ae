// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/surface_tracker.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

Vec3 tangential(const Vec3& v_W, const Vec3& normal_W) noexcept {
  return v_W - normal_W * normal_W.dot(v_W);
}

Vec3 shortened(const Vec3& v_W, double longest_m) noexcept {
  const double squared_m2 = v_W.squaredNorm();
  return squared_m2 <= longest_m * longest_m ? v_W : Vec3(v_W * (longest_m / std::sqrt(squared_m2)));
}

// Where the sampled gradient and the interpolated density disagree (a wall of one voxel), plain Newton swings or
// crawls. The ratio of two residuals gives the true slope, as in the secant method.
class NewtonGain {
 public:
  [[nodiscard]] double update(double residual_m) noexcept {
    if (comparable_) {
      const double ratio = residual_m / last_m_;
      gain_ = std::clamp(gain_ / (1 - std::min(ratio, 0.75)), 0.25, 4.0);
    }
    last_m_ = residual_m;
    return gain_;
  }
  // A residual can be compared with the next one only if the step between was mostly along the normal. Both parts are
  // often cut short to a voxel: the bound keeps away from that tie.
  void stepped(double normal_m, double tangential_squared_m2) noexcept {
    comparable_ = tangential_squared_m2 <= 0.9 * normal_m * normal_m && normal_m != 0;
  }

 private:
  double gain_ = 1;
  double last_m_ = 0;
  bool comparable_ = false;
};

// The share of the way aside that a step takes. A step that swung or went nowhere halves it; one that gained in the
// same direction, but little, raises it.
class Pace {
 public:
  explicit Pace(double share) noexcept : share_(share) {}

  void see(const Vec3& aside_W, double squared_m2) noexcept {
    if (last_squared_m2_ > 0) {
      const double dot_m2 = aside_W.dot(last_W_);
      const bool same_way = dot_m2 > 0 && 4 * dot_m2 * dot_m2 > squared_m2 * last_squared_m2_;
      if (!same_way || squared_m2 >= last_squared_m2_) {
        if (squared_m2 > 0.25 * last_squared_m2_) share_ = std::max(share_ / 2, SurfaceTracker::kLowestPace);
      } else if (!cut_short_ && squared_m2 > 0.1 * last_squared_m2_) {
        share_ = std::min(share_ * 1.5, SurfaceTracker::kHighestPace);
      }
    }
    last_W_ = aside_W;
    last_squared_m2_ = squared_m2;
  }
  void cutShort(bool cut_short) noexcept { cut_short_ = cut_short; }
  [[nodiscard]] double share() const noexcept { return share_; }

 private:
  double share_;
  Vec3 last_W_ = Vec3::Zero();
  double last_squared_m2_ = 0;
  bool cut_short_ = false;
};

// The sampled normal at p, turned towards the line from the HIP to p.
[[gnu::noinline, gnu::cold]] Vec3 turned(const Vec3& normal_W, const Vec3& to_p_W, double h_m) noexcept {
  const double length_m = to_p_W.norm();
  if (!(length_m > 0) || !(normal_W.dot(to_p_W) > -0.5 * length_m)) return normal_W;
  const double share = length_m / (length_m + SurfaceTracker::kHalfTurned * h_m);
  return (normal_W * (1 - share) + to_p_W * (share / length_m)).normalized();
}

// The mean of the normals at p and at six points around it in the tangent plane, wider apart the deeper the press: what
// a tip that presses so deep would feel of bumps. Steeper places count for more. The six are the lattice's axes laid
// onto the plane, so they turn with the normal without a step.
[[gnu::noinline, gnu::cold]] Vec3 meanNormal(const IsoField& field, const Vec3& p_W, const Vec3& normal_W,
                                             double depth_m) noexcept {
  const double h_m = field.voxel();
  const double spread_m = std::clamp(SurfaceTracker::kSpread * depth_m, SurfaceTracker::kLeastSpread * h_m,
                                     SurfaceTracker::kMostSpread * h_m);
  Vec3 uphill_W = field.sampler().at(p_W).gradient_W;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 aside_W = tangential(field.sampler().faceNormal(axis, true), normal_W) * spread_m;
    for (const Vec3& there_W : {Vec3(p_W + aside_W), Vec3(p_W - aside_W)}) {
      const Vec3 gradient_W = field.sampler().at(there_W).gradient_W;
      if (gradient_W.allFinite()) uphill_W += gradient_W;
    }
  }
  const double length = uphill_W.norm();
  return length > 0 && std::isfinite(length) ? Vec3(uphill_W / -length) : normal_W;
}

}  // namespace

Track SurfaceTracker::follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, TrackMemory& memory,
                             const Limits& limits) noexcept {
  return surface.face.any() ? followFace(field, hip_W, surface, memory, limits)
                            : followIsosurface(field, hip_W, surface, memory, limits);
}

Track SurfaceTracker::followIsosurface(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                       TrackMemory& memory, const Limits& limits) noexcept {
  const Vec3 last_W = surface.normal_W;
  SurfacePoint found = surface;
  const Track result = newton(field, hip_W, found, memory, limits);
  const bool turned_over = (result == Track::kFound || result == Track::kBehind) && found.normal_W.dot(last_W) <= 0;
  if (!turned_over && result != Track::kLost && result != Track::kFlat) {
    surface = found;
    return result;
  }
  // A cast goes one voxel aside, so a long way takes several.
  for (int casts = 0; casts < kMaxCasts; ++casts) {
    const Track again = cast(field, hip_W, surface, memory.rough);
    if (again == Track::kLost) return casts > 0 ? Track::kBehind : result == Track::kFlat ? Track::kFlat : Track::kLost;
    if (tangential(hip_W - surface.p_W, surface.normal_W).norm() <= field.voxel()) return again;
  }
  return Track::kBehind;
}

// Moves `surface` only when it finds the sheet. Keeps the old normal where the sampled one turns over or is none.
Track SurfaceTracker::cast(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, bool rough) noexcept {
  const double h_m = field.voxel();
  const Vec3 foot_W = surface.p_W + shortened(tangential(hip_W - surface.p_W, surface.normal_W), h_m);
  const Vec3 reach_W = surface.normal_W * (kCastReach * h_m);
  const auto entry = field.firstEntry(field.probe(foot_W + reach_W), field.probe(foot_W - reach_W));
  if (!entry || entry->face.any()) return Track::kLost;
  surface.p_W = entry->p_W;
  if (rough) {
    surface.normal_W = turned(surface.normal_W, surface.p_W - hip_W, h_m);
    return Track::kFound;
  }
  const Vec3 out_W = -field.sampler().at(entry->p_W).gradient_W;
  const double steepness = out_W.norm();
  if (!(out_W.dot(surface.normal_W) > 0) || !std::isfinite(steepness)) return Track::kFoundFlat;
  surface.normal_W = out_W / steepness;
  return Track::kFound;
}

Track SurfaceTracker::newton(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, TrackMemory& memory,
                             const Limits& limits) noexcept {
  const double h_m = field.voxel();
  const double line_squared_m2 = limits.line_tolerance * limits.line_tolerance * h_m * h_m;
  const Vec3 way_W = tangential(hip_W - surface.p_W, surface.normal_W);
  Vec3 x_W = surface.p_W + shortened(way_W, h_m);
  // A HIP that went farther than a voxel is followed voxel by voxel first: on a rough surface, where the way aside is
  // never short, for as many as it went; otherwise until it is less than one aside or comes no nearer.
  int voxels_left = 0;
  double nearest_squared_m2 = std::numeric_limits<double>::infinity();
  bool behind = false;
  if (way_W.squaredNorm() > h_m * h_m) {
    const double voxels = std::ceil(way_W.norm() / h_m) - 1;
    behind = voxels > kMaxWay;
    voxels_left = memory.rough && !behind ? static_cast<int>(voxels) : kMaxWay;
  }
  double slide_m = -1;  // what is left of it; not known yet
  NewtonGain gain;
  Pace pace(memory.pace);
  bool rough = memory.rough;
  SurfacePoint best;
  double best_m = kUsable * h_m;
  bool agreed = false;
  bool clamped = false;
  for (int steps_left = rough ? kRoughSteps : kMaxSteps; steps_left > 0;) {
    Fetch f = field.sampler().at(x_W);
    if (f.place == Place::kBeyondWindow) return Track::kBeyondWindow;
    if (f.place == Place::kBeyondVolume) {
      clamped = true;
      x_W = field.clampToBox(x_W);
      f = field.sampler().at(x_W);
    }
    const double steepness_squared = f.gradient_W.squaredNorm();
    if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) return Track::kFlat;
    // Where the next step goes needs 1 / |g|^2 only; the roots, for what is measured in metres, run beside it.
    const double per_squared = 1 / steepness_squared;
    const double steepness = std::sqrt(steepness_squared);
    const double excess = f.density - field.isovalue();
    const double residual_m = excess / steepness;  // depth of x below the surface
    if (!std::isfinite(residual_m)) return Track::kLost;
    const double gained = gain.update(residual_m);
    const double climb_m = std::clamp(gained * residual_m, -h_m, h_m);
    const bool whole_climb = std::abs(gained * residual_m) <= h_m;
    const Vec3 climb_W = f.gradient_W * (whole_climb ? -gained * excess * per_squared : -climb_m / steepness);
    const Vec3 line_W = hip_W - x_W;
    Vec3 aside_W = line_W - f.gradient_W * (f.gradient_W.dot(line_W) * per_squared);
    double aside_squared_m2 = aside_W.squaredNorm();
    Vec3 normal_W = f.gradient_W / -steepness;
    if (rough) {
      const double depth_m = line_W.norm();
      const Vec3 mean_W = meanNormal(field, x_W, normal_W, depth_m);
      rough = (mean_W - normal_W).norm() * depth_m > kRough * h_m;
      if (rough) {
        normal_W = mean_W;
        aside_W = tangential(line_W, normal_W);
        aside_squared_m2 = aside_W.squaredNorm();
      }
    }
    if (std::abs(climb_m) <= best_m) {
      best.p_W = x_W + climb_W;
      best.normal_W = normal_W;
      best_m = std::max(std::abs(climb_m), kDensityTolerance * h_m);
      agreed = aside_squared_m2 <= line_squared_m2;
      if (best_m <= kDensityTolerance * h_m && agreed) break;
    }
    Vec3 move_W;
    if (voxels_left > 0 && (rough || (aside_squared_m2 > h_m * h_m && aside_squared_m2 < nearest_squared_m2))) {
      --voxels_left;
      if (voxels_left == 0 && !memory.rough) behind = true;
      nearest_squared_m2 = aside_squared_m2;
      move_W = shortened(rough ? tangential(line_W, turned(normal_W, -line_W, h_m)) : aside_W, h_m);
    } else {
      voxels_left = 0;
      --steps_left;
      if (slide_m < 0) slide_m = limits.slide_m + limits.slide_by_way * std::sqrt(limits.way_squared_m2);
      if (aside_squared_m2 > line_squared_m2) pace.see(aside_W, aside_squared_m2);
      const double longest_m = std::min(h_m, slide_m);
      move_W = aside_W * pace.share();
      const double wanted_squared_m2 = aside_squared_m2 * pace.share() * pace.share();
      const bool cut_short = wanted_squared_m2 > longest_m * longest_m;
      pace.cutShort(cut_short);
      const double wanted_m = std::sqrt(wanted_squared_m2);
      if (cut_short) move_W *= longest_m / wanted_m;
      slide_m -= std::min(wanted_m, longest_m);
    }
    gain.stepped(climb_m, move_W.squaredNorm());
    x_W += climb_W + move_W;
  }
  if (clamped && field.sampler().place(hip_W) == Place::kBeyondVolume) return Track::kLeftVolume;
  if (best.normal_W.isZero(0)) return Track::kLost;
  surface.p_W = best.p_W;
  surface.normal_W = agreed || behind ? best.normal_W : turned(best.normal_W, best.p_W - hip_W, h_m);
  memory.pace = pace.share();
  memory.rough = rough || (!agreed && !behind);
  // A point in a pit agrees with the line, too.
  const double depth_m = best.normal_W.dot(best.p_W - hip_W);
  const double judged_for_m = kJudgedFor * h_m;
  if (!memory.rough && depth_m > kDeep * h_m &&
      (best.p_W - memory.judged_W).squaredNorm() > judged_for_m * judged_for_m) {
    const Vec3 mean_W = meanNormal(field, best.p_W, best.normal_W, depth_m);
    memory.rough = (mean_W - best.normal_W).norm() * depth_m > kRough * h_m;
    memory.judged_W = best.p_W;
  }
  return behind ? Track::kBehind : Track::kFound;
}

// The nearest point of the face; where the object has ended on the way there, the isosurface takes over from its edge.
Track SurfaceTracker::followFace(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, TrackMemory& memory,
                                 const Limits& limits) noexcept {
  const WindowSampler& sampler = field.sampler();
  const int axis = surface.face.axis;
  const double last = sampler.lastIndex()[axis];
  const auto onFace = [&](const Vec3& p_W) {
    Vec3 p_L = sampler.toIndex(p_W).cwiseMax(Vec3::Zero()).cwiseMin(sampler.lastIndex());
    p_L[axis] = surface.face.high ? last : 0.0;
    return field.probe(sampler.toWorld(p_L));
  };
  // A window moves with the tool, so the face must still be one of the volume's and not just the window's end.
  const Vec3 beyond_W = sampler.toWorld(sampler.toIndex(surface.p_W)) + surface.normal_W * field.voxel();
  if (sampler.place(beyond_W) != Place::kBeyondVolume) return Track::kBeyondWindow;
  const Probe nearest = onFace(hip_W);
  if (nearest.side == Side::kInside) {
    surface.p_W = nearest.p_W;
    return Track::kFound;
  }
  Vec3 object_W = onFace(surface.p_W).p_W;
  if (field.probe(object_W).side != Side::kInside) return Track::kLost;
  Vec3 background_W = nearest.p_W;
  for (int i = 0; i < kMaxEdgeSteps; ++i) {
    const Vec3 middle_W = 0.5 * (object_W + background_W);
    (field.probe(middle_W).side == Side::kInside ? object_W : background_W) = middle_W;
  }
  SurfacePoint edge{object_W, -field.sampler().at(object_W).gradient_W, {}};
  if (!(edge.normal_W.squaredNorm() > 0)) return Track::kFlat;
  edge.normal_W.normalize();
  const Track result = followIsosurface(field, hip_W, edge, memory, limits);
  if (result == Track::kFound || result == Track::kFoundFlat || result == Track::kBehind) surface = edge;
  return result;
}

}  // namespace palpate
