// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/surface_tracker.hpp"

#include <algorithm>
#include <cmath>

#include "servo/contact/surface_patch.hpp"

namespace palpate {
namespace {

[[gnu::always_inline]] inline Vec3 tangential(const Vec3& v_W, const Vec3& normal_W) noexcept {
  return v_W - normal_W * normal_W.dot(v_W);
}

// A gain for Newton steps. Where the sampled gradient and the interpolated density disagree (a wall of one voxel),
// plain Newton swings or crawls. The ratio of two residuals gives the true slope, as in the secant method.
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
  // A residual can be compared with the next one only if the step between them was mostly along the normal. Both parts
  // of a step are often cut to a voxel. The bound of 0.9 keeps away from that tie.
  void stepped(double normal_m, double tangential_squared_m2) noexcept {
    comparable_ = tangential_squared_m2 <= 0.9 * normal_m * normal_m && normal_m != 0;
  }

 private:
  double gain_ = 1;
  double last_m_ = 0;
  bool comparable_ = false;
};

// The share of the lateral offset that a step takes. A step that swung or gained nothing halves it. A step that gained
// little in the same direction raises it.
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

// The mean normal of the patch around p.
[[gnu::noinline, gnu::cold]] Vec3 meanNormal(const IsoField& field, const Vec3& p_W, const Vec3& normal_W,
                                             double depth_m) noexcept {
  const SurfacePatch patch(field.sampler(), p_W, normal_W, {.depth_m = depth_m});
  return patch.known() ? patch.normal() : normal_W;
}

// Judges whether the surface is rough at a point that was found. It may be: in a pit a point agrees with the line, too.
void judge(const IsoField& field, const Vec3& hip_W, const Vec3& p_W, const Vec3& normal_W,
           TrackMemory& memory) noexcept {
  const double h_m = field.voxel();
  const double depth_m = normal_W.dot(p_W - hip_W);
  const double judged_for_m = SurfaceTracker::kJudgedFor * h_m;
  if (!(depth_m > SurfaceTracker::kDeep * h_m)) return;
  if (!((p_W - memory.judged_W).squaredNorm() > judged_for_m * judged_for_m)) return;
  const Vec3 mean_W = meanNormal(field, p_W, normal_W, depth_m);
  memory.rough = SurfaceTracker::apart(mean_W, normal_W, depth_m) > SurfaceTracker::kRough * h_m;
  memory.judged_W = p_W;
}

// The short search: most end at their first place, before a SheetWalk is made. `f`: the field at x.
[[nodiscard]] bool foundAtOnce(const IsoField& field, const Vec3& hip_W, const Vec3& x_W, const Fetch& f,
                               double line_tolerance, SurfacePoint& surface) noexcept {
  if (f.place != Place::kInside) return false;
  const double h_squared_m2 = field.voxel() * field.voxel();
  const double steepness_squared = f.gradient_W.squaredNorm();
  const double excess = f.density - field.isovalue();
  constexpr double kClose = SurfaceTracker::kDensityTolerance;
  if (!(excess * excess <= kClose * kClose * h_squared_m2 * steepness_squared)) return false;
  const double per_squared = 1 / steepness_squared;
  const Vec3 line_W = hip_W - x_W;
  const Vec3 aside_W = line_W - f.gradient_W * (f.gradient_W.dot(line_W) * per_squared);
  if (!(aside_W.squaredNorm() <= line_tolerance * line_tolerance * h_squared_m2)) return false;
  const Vec3 normal_W = f.gradient_W * -std::sqrt(per_squared);
  if (!(normal_W.dot(surface.normal_W) > 0)) return false;
  surface.p_W = x_W - f.gradient_W * (excess * per_squared);
  surface.normal_W = normal_W;
  return true;
}

// One search along the isosurface. It begins at the surface point of the last search and goes a step at a time.
class SheetWalk {
 public:
  // From `x_W`. `way_W`: the HIP's motion along the surface.
  SheetWalk(const IsoField& field, const Vec3& hip_W, const Vec3& x_W, const Vec3& way_W, const TrackMemory& memory,
            const SurfaceTracker::Limits& limits) noexcept
      : field_(field),
        hip_W_(hip_W),
        limits_(limits),
        h_m_(field.voxel()),
        line_squared_m2_(limits.line_tolerance * limits.line_tolerance * h_m_ * h_m_),
        x_W_(x_W),
        pace_(memory.pace),
        slide_times_(memory.slide),
        began_rough_(memory.rough),
        rough_(memory.rough) {
    const double squared = field.sampler().squaredVoxels(way_W);
    if (!(squared > 1)) return;
    const double voxels = std::ceil(std::sqrt(squared)) - 1;
    behind_ = voxels > SurfaceTracker::kMaxWay;
    voxels_left_ = rough_ && !behind_ ? static_cast<int>(voxels) : SurfaceTracker::kMaxWay;
  }

  // kFound, kBehind, or why there is no point. `first`: the field at x.
  [[nodiscard]] Track run(const Fetch& first) noexcept {
    Fetch f = first;
    for (steps_left_ = began_rough_ ? SurfaceTracker::kRoughSteps : SurfaceTracker::kMaxSteps; steps_left_ > 0;) {
      if (const Track seen = look(f); seen != Track::kFound) return seen;
      if (keep()) break;
      move();
      f = field_.sampler().at(x_W_);
    }
    if (clamped_ && field_.sampler().place(hip_W_) == Place::kBeyondVolume) return Track::kLeftVolume;
    if (normal_W_.isZero(0)) return Track::kLost;
    return behind_ ? Track::kBehind : Track::kFound;
  }

  // The result of a search that found a point.
  void result(SurfacePoint& surface, TrackMemory& memory) const noexcept {
    surface.p_W = p_W_;
    surface.normal_W = agreed_ || behind_ ? normal_W_ : turned(normal_W_, p_W_ - hip_W_, h_m_);
    memory.pace = pace_.share();
    memory.rough = rough_ || (!agreed_ && !behind_);
    memory.short_of_way = !agreed_ && (slide_m_ == 0 || isFar(aside_W_));
    memory.slide = memory.short_of_way
                       ? std::min(slide_times_ * SurfaceTracker::kSlideGrowth, limits_.slide_by_way)
                       : std::max(slide_times_ * SurfaceTracker::kSlideDecay, SurfaceTracker::kLeastSlide);
    if (!memory.rough) judge(field_, hip_W_, p_W_, normal_W_, memory);
  }

 private:
  // Evaluates the field at x: how far x is from the surface, and by how much its normal line misses the HIP.
  [[nodiscard]] Track look(Fetch& f) noexcept {
    if (f.place == Place::kBeyondWindow) return Track::kBeyondWindow;
    if (f.place == Place::kBeyondVolume) {
      clamped_ = true;
      x_W_ = field_.clampToBox(x_W_);
      f = field_.sampler().at(x_W_);
    }
    const double steepness_squared = f.gradient_W.squaredNorm();
    if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) return Track::kLost;
    // The next step needs 1 / |g|^2 only. The square roots are for lengths in metres; nothing waits for them.
    const double per_squared = 1 / steepness_squared;
    const double steepness = std::sqrt(steepness_squared);
    const double excess = f.density - field_.isovalue();
    const double residual_m = excess / steepness;  // depth of x below the surface
    if (!std::isfinite(residual_m)) return Track::kLost;
    const double gained = gain_.update(residual_m);
    up_m_ = field_.sampler().voxelAlong(f.gradient_W);
    climb_m_ = std::clamp(gained * residual_m, -up_m_, up_m_);
    const bool whole_climb = std::abs(gained * residual_m) <= up_m_;
    climb_W_ = f.gradient_W * (whole_climb ? -gained * excess * per_squared : -climb_m_ / steepness);
    line_W_ = hip_W_ - x_W_;
    aside_W_ = line_W_ - f.gradient_W * (f.gradient_W.dot(line_W_) * per_squared);
    here_W_ = f.gradient_W / -steepness;
    if (rough_) lookAround();
    aside_squared_m2_ = aside_W_.squaredNorm();
    return Track::kFound;
  }

  void lookAround() noexcept {
    const double depth_m = line_W_.norm();
    const Vec3 mean_W = meanNormal(field_, x_W_, here_W_, depth_m);
    rough_ = SurfaceTracker::apart(mean_W, here_W_, depth_m) > SurfaceTracker::kRough * h_m_;
    if (!rough_) return;
    here_W_ = mean_W;
    aside_W_ = tangential(line_W_, mean_W);
  }

  // Keeps x if it is the nearest to the surface so far. True: it is on the surface, and its normal line meets the HIP.
  [[nodiscard]] bool keep() noexcept {
    if (std::abs(climb_m_) > std::min(best_m_, SurfaceTracker::kUsable * up_m_)) return false;
    p_W_ = x_W_ + climb_W_;
    normal_W_ = here_W_;
    const double close_m = SurfaceTracker::kDensityTolerance * h_m_;
    best_m_ = std::max(std::abs(climb_m_), close_m);
    agreed_ = aside_squared_m2_ <= line_squared_m2_;
    return agreed_ && best_m_ <= close_m;
  }

  void move() noexcept {
    const Vec3 move_W = farAside() ? onward() : slide();
    gain_.stepped(climb_m_, move_W.squaredNorm());
    x_W_ += climb_W_ + move_W;
  }

  // A HIP that moved farther than a voxel is first followed voxel by voxel. On a rough surface, where the lateral
  // offset is never short, that goes on for as many voxels as the HIP moved. Otherwise it ends when the offset is below
  // a voxel or shrinks no more.
  [[nodiscard]] bool farAside() const noexcept {
    return voxels_left_ > 0 && (rough_ || (aside_squared_m2_ < nearest_squared_m2_ && isFar(aside_W_)));
  }
  [[nodiscard]] bool isFar(const Vec3& way_W) const noexcept { return field_.sampler().squaredVoxels(way_W) > 1; }

  [[nodiscard]] Vec3 onward() noexcept {
    --voxels_left_;
    if (voxels_left_ == 0 && !began_rough_) behind_ = true;
    nearest_squared_m2_ = aside_squared_m2_;
    return field_.cutToVoxel(rough_ ? tangential(line_W_, turned(here_W_, -line_W_, h_m_)) : aside_W_);
  }

  // Towards where the normal line meets the HIP.
  [[nodiscard]] Vec3 slide() noexcept {
    voxels_left_ = 0;
    --steps_left_;
    if (slide_m_ < 0) {
      const double times = began_rough_ ? slide_times_ : limits_.slide_by_way;
      slide_m_ = limits_.slide_m + times * std::sqrt(limits_.way_squared_m2);
    }
    if (aside_squared_m2_ > line_squared_m2_) pace_.see(aside_W_, aside_squared_m2_);
    const Vec3 wanted_W = aside_W_ * pace_.share();
    const double wanted_m = std::sqrt(aside_squared_m2_) * pace_.share();
    const double longest_m = std::min(field_.sampler().voxelAlong(aside_W_), slide_m_);
    pace_.cutShort(wanted_m > longest_m);
    slide_m_ -= std::min(wanted_m, longest_m);
    return wanted_m > longest_m ? Vec3(wanted_W * (longest_m / wanted_m)) : wanted_W;
  }

  const IsoField& field_;
  const Vec3 hip_W_;
  const SurfaceTracker::Limits& limits_;
  double h_m_;
  double line_squared_m2_;
  Vec3 x_W_;
  // At x:
  Vec3 here_W_ = Vec3::Zero();   // normal
  Vec3 climb_W_ = Vec3::Zero();  // Newton step to the isovalue
  double climb_m_ = 0;
  double up_m_ = 0;              // a voxel along the gradient
  Vec3 line_W_ = Vec3::Zero();   // to the HIP
  Vec3 aside_W_ = Vec3::Zero();  // the part of that line along the surface: the lateral offset
  double aside_squared_m2_ = 0;
  // The best so far:
  Vec3 p_W_ = Vec3::Zero();
  Vec3 normal_W_ = Vec3::Zero();
  double best_m_ = std::numeric_limits<double>::infinity();
  bool agreed_ = false;  // its normal line meets the HIP
  // Of the search:
  NewtonGain gain_;
  Pace pace_;
  double slide_times_;
  bool began_rough_;
  bool rough_;
  int steps_left_ = 0;   // besides those that follow the HIP's motion
  int voxels_left_ = 0;  // of the HIP's motion, after the first voxel
  // The smallest lateral offset while the HIP's motion was followed.
  double nearest_squared_m2_ = std::numeric_limits<double>::infinity();
  bool behind_ = false;
  double slide_m_ = -1;  // how far the point may still slide; -1: not known yet
  bool clamped_ = false;
};

}  // namespace

Track SurfaceTracker::follow(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, TrackMemory& memory,
                             const Limits& limits) noexcept {
  return surface.face.any() ? followFace(field, hip_W, surface, memory, limits)
                            : followIsosurface(field, hip_W, surface, memory, limits);
}

Track SurfaceTracker::followIsosurface(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface,
                                       TrackMemory& memory, const Limits& limits) noexcept {
  const Vec3 way_W = tangential(hip_W - surface.p_W, surface.normal_W);
  const Vec3 x_W = surface.p_W + field.cutToVoxel(way_W);
  const Fetch first = field.sampler().at(x_W);
  if (!memory.rough && foundAtOnce(field, hip_W, x_W, first, limits.line_tolerance, surface)) {
    memory.short_of_way = false;
    judge(field, hip_W, surface.p_W, surface.normal_W, memory);
    return Track::kFound;
  }
  SheetWalk walk(field, hip_W, x_W, way_W, memory, limits);
  const Track result = walk.run(first);
  if (result == Track::kFound || result == Track::kBehind) {
    SurfacePoint found;
    walk.result(found, memory);
    if (found.normal_W.dot(surface.normal_W) > 0) {
      surface = found;
      return result;
    }
  } else if (result != Track::kLost) {
    return result;
  }
  // A cast moves the point by at most one voxel, so a long lateral offset takes several.
  for (int casts = 0; casts < kMaxCasts; ++casts) {
    const Track again = cast(field, hip_W, surface, memory.rough);
    if (again == Track::kLost) return casts > 0 ? Track::kBehind : Track::kLost;
    if (field.sampler().squaredVoxels(tangential(hip_W - surface.p_W, surface.normal_W)) <= 1) return again;
  }
  return Track::kBehind;
}

// Moves `surface` only if it finds the sheet. Keeps the old normal if the sampled one turns over or is zero.
Track SurfaceTracker::cast(const IsoField& field, const Vec3& hip_W, SurfacePoint& surface, bool rough) noexcept {
  const Vec3 foot_W = surface.p_W + field.cutToVoxel(tangential(hip_W - surface.p_W, surface.normal_W));
  const Vec3 reach_W = surface.normal_W * (kCastReach * field.sampler().voxelAlong(surface.normal_W));
  const auto entry = field.firstEntry(field.probe(foot_W + reach_W), field.probe(foot_W - reach_W));
  if (!entry || entry->face.any()) return Track::kLost;
  surface.p_W = entry->p_W;
  if (rough) {
    surface.normal_W = turned(surface.normal_W, surface.p_W - hip_W, field.voxel());
    return Track::kFound;
  }
  const Vec3 out_W = -field.sampler().at(entry->p_W).gradient_W;
  const double steepness = out_W.norm();
  if (!(out_W.dot(surface.normal_W) > 0) || !std::isfinite(steepness)) return Track::kFoundFlat;
  surface.normal_W = out_W / steepness;
  return Track::kFound;
}

// Goes to the nearest point of the face. If the object ends on the way there, the isosurface takes over from that edge.
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
  // The window moves with the tool. So the face must be checked: it may now be inside the volume, an end of the window
  // only.
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
  if (!(edge.normal_W.squaredNorm() > 0)) return Track::kLost;
  edge.normal_W.normalize();
  const Track result = followIsosurface(field, hip_W, edge, memory, limits);
  if (result == Track::kFound || result == Track::kFoundFlat || result == Track::kBehind) surface = edge;
  return result;
}

}  // namespace palpate
