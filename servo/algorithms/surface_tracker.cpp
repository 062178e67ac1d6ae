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
  // A residual can be compared with the next one only if the step between was mostly along the normal.
  void stepped(double normal_m, double tangential_squared_m2) noexcept {
    comparable_ = tangential_squared_m2 <= normal_m * normal_m && normal_m != 0;
  }

 private:
  double gain_ = 1;
  double last_m_ = 0;
  bool comparable_ = false;
};

}  // namespace

Track SurfaceTracker::follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept {
  return surface.face.any() ? followFace(field, hip_W, surface) : followIsosurface(field, hip_W, surface);
}

Track SurfaceTracker::followIsosurface(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept {
  SurfacePoint found = surface;
  const Track result = newton(field, hip_W, found);
  const bool turned_over = result == Track::kFound && found.normal_W.dot(surface.normal_W) <= 0;
  if (!turned_over && result != Track::kLost && result != Track::kFlat) {
    surface = found;
    return result;
  }
  const Track again = cast(field, hip_W, surface);
  return again == Track::kLost && result == Track::kFlat ? Track::kFlat : again;
}

// Moves `surface` only when it finds the sheet. Keeps the old normal where the sampled one turns over or is none.
Track SurfaceTracker::cast(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept {
  const double h_m = field.voxel();
  const Vec3 foot_W = surface.p_W + shortened(tangential(hip_W - surface.p_W, surface.normal_W), h_m);
  const Vec3 reach_W = surface.normal_W * (kCastReach * h_m);
  const auto entry = field.firstEntry(field.probe(foot_W + reach_W), field.probe(foot_W - reach_W));
  if (!entry || entry->face.any()) return Track::kLost;
  surface.p_W = entry->p_W;
  const Vec3 out_W = -field.sampler().at(entry->p_W).gradient_W;
  const double steepness = out_W.norm();
  if (!(out_W.dot(surface.normal_W) > 0) || !std::isfinite(steepness)) return Track::kFoundFlat;
  surface.normal_W = out_W / steepness;
  return Track::kFound;
}

Track SurfaceTracker::newton(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept {
  const double h_m = field.voxel();
  const double line_squared_m2 = kLineTolerance * kLineTolerance * h_m * h_m;
  Vec3 x_W = surface.p_W + shortened(tangential(hip_W - surface.p_W, surface.normal_W), h_m);
  NewtonGain gain;
  SurfacePoint best;
  double best_m = kUsable * h_m;
  bool clamped = false;
  for (int step = 0; step < kMaxSteps; ++step) {
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
    const Vec3 aside_W = line_W - f.gradient_W * (f.gradient_W.dot(line_W) * per_squared);
    const double aside_squared_m2 = aside_W.squaredNorm();
    if (std::abs(climb_m) <= best_m) {
      best = {x_W + climb_W, f.gradient_W / -steepness, {}};
      best_m = std::max(std::abs(climb_m), kDensityTolerance * h_m);
      if (best_m <= kDensityTolerance * h_m && aside_squared_m2 <= line_squared_m2) break;
    }
    const Vec3 move_W = shortened(aside_W, h_m);
    gain.stepped(climb_m, move_W.squaredNorm());
    x_W += climb_W + move_W;
  }
  if (clamped && field.sampler().place(hip_W) == Place::kBeyondVolume) return Track::kLeftVolume;
  if (best.normal_W.isZero(0)) return Track::kLost;
  surface = best;
  return Track::kFound;
}

// The nearest point of the face; where the object has ended on the way there, the isosurface takes over from its edge.
Track SurfaceTracker::followFace(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface) noexcept {
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
  const Track result = followIsosurface(field, hip_W, edge);
  if (result == Track::kFound || result == Track::kFoundFlat) surface = edge;
  return result;
}

}  // namespace palpate
