// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "servo/safety/faults.hpp"

namespace palpate {
namespace {

constexpr double kNoReach = -1;  // the plane is renewed in the next tick [m^2]

// The squared length of the part of a displacement along the plane [m^2].
[[gnu::always_inline]] inline double tangentialSquared(const Vec3& way_W, const Vec3& normal_W) noexcept {
  const double along_m = normal_W.dot(way_W);
  return std::max(0.0, way_W.squaredNorm() - along_m * along_m);
}

}  // namespace

void HriSurface::reset(const Vec3& hip_W) noexcept {
  surface_ = {};
  age_ticks_ = 0;
  vhip_W_ = hip_W;
  tool_ = Tool::kInside;
  held_ = behind_ = buried_ = resumed_ = false;
  edit_version_ = 0;
  cache_.forget();
}

// As after ticks that could not see the HIP.
void HriSurface::resume(const Vec3& free_W) noexcept {
  free_.p_W = free_W;
  tool_ = Tool::kFree;
  held_ = resumed_ = true;
}

bool HriSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (!window.usable()) {
    held_ = true;
    faults |= bit(ServoFault::kNoWindow);
  } else if (window.edit_version != edit_version_) {
    if (inContact()) ++age_ticks_;
    const bool was_outside = inContact() || tool_ == Tool::kFree;
    refreshField(window);
    if (inContact()) {
      renew(hip_W, false, faults);
      const Probe hip = field_->probe(hip_W);
      if (inContact() && !held_ && field_->inAirBehind(plane().nearest(hip_W), surface_.normal_W, hip)) release(hip);
    } else {
      moveFreely(hip_W, faults);
    }
    if (was_outside && !inContact() && tool_ != Tool::kFree) {
      const Probe hip = field_->probe(hip_W);
      buried_ = hip.side == Side::kUnknown;  // the window does not show the HIP: the way out is searched later
      if (!buried_) takeNearestExit(hip, faults);
    }
  } else if (!inContact()) {
    refreshField(window);
    moveFreely(hip_W, faults);
  } else {
    ++age_ticks_;
    const bool in_front = plane().depth(hip_W) <= 0;
    const bool due = age_ticks_ >= renewal_ticks_ || leftReach(hip_W);
    if (due || in_front || held_) {
      refreshField(window);
      renew(hip_W, !in_front && !held_ && !memory_.short_of_way, faults);
    }
  }
  const bool touching = inContact() && !held_;
  if (touching) vhip_W_ = plane().nearest(hip_W);
  if (!inContact()) vhip_W_ = hip_W;
  return touching;
}

void HriSurface::refreshField(const SampleWindow& window) noexcept {
  field_ = &cache_.of(window);
  if (window.edit_version == edit_version_) return;
  edit_version_ = window.edit_version;
  if (tool_ != Tool::kFree) return;
  // Material that an edit put over the last free point is no entry.
  const Probe again = field_->probe(free_.p_W);
  if (again.side == Side::kInside) tool_ = Tool::kInside;
  if (again.side == Side::kOutside) free_ = again;
}

// ---- in contact ----

bool HriSurface::leftReach(const Vec3& hip_W) const noexcept {
  return tangentialSquared(hip_W - found_for_W_, surface_.normal_W) > reach_squared_m2_;
}

// Where the HIP will be a third of the way through the plane's life, if it goes on along the surface as it did. Half
// would centre the normal's error in time. But an old plane puts the VHIP outward of a convex surface, which makes up
// for the sag of trilinear interpolation. A third keeps most of both (docs/hri-mends.md).
Vec3 HriSurface::aim(const Vec3& hip_W) const noexcept {
  const Vec3 way_W = hip_W - renewed_at_W_;
  const Vec3 aside_W = way_W - surface_.normal_W * surface_.normal_W.dot(way_W);
  const Vec3 lead_W = aside_W * (kAim * (renewal_ticks_ - 1) / age_ticks_);
  const double voxel_m = field_->voxel();
  const double longest_squared_m2 = std::min(kLongestAim * kLongestAim * voxel_m * voxel_m,
                                             kAimInReach * kAimInReach * std::max(0.0, reach_squared_m2_));
  const double squared_m2 = lead_W.squaredNorm();
  return hip_W +
         (squared_m2 <= longest_squared_m2 ? lead_W : Vec3(lead_W * std::sqrt(longest_squared_m2 / squared_m2)));
}

Track HriSurface::follow(const Vec3& hip_W, bool ahead) noexcept {
  // A plane that lags has more to catch up with than the last motion of the HIP, so its slide is not limited.
  SurfaceTracker::Limits limits{.line_tolerance = kAimTolerance,
                                .slide_m = behind_ ? std::numeric_limits<double>::infinity() : kSlide * field_->voxel(),
                                .slide_by_way = kSlideByWay,
                                .way_squared_m2 = (hip_W - renewed_at_W_).squaredNorm()};
  if (ahead && renewal_ticks_ > 1) {
    SurfacePoint found = surface_;
    found_for_W_ = aim(hip_W);
    const Track result = SurfaceTracker::follow(*field_, found_for_W_, found, memory_, limits);
    if (result == Track::kFound && found.normal_W.dot(found.p_W - hip_W) > 0) {
      surface_ = found;
      return result;
    }
  }
  found_for_W_ = hip_W;
  limits.line_tolerance = SurfaceTracker::kLineTolerance;
  return SurfaceTracker::follow(*field_, hip_W, surface_, memory_, limits);
}

void HriSurface::renew(const Vec3& hip_W, bool ahead, std::uint32_t& faults) noexcept {
  const Vec3 last_normal_W = surface_.normal_W;
  Track result = follow(hip_W, ahead && !behind_);
  // The HIP may be anywhere, but the surface point must be in the window. If the window no longer holds it, the best
  // known place is the point of the plane under the HIP.
  const auto seen = [&] { return field_->sampler().place(surface_.p_W) != Place::kBeyondWindow; };
  if (result == Track::kBeyondWindow && !seen()) {
    surface_.p_W = plane().nearest(hip_W);
    if (seen()) result = follow(hip_W, false);
  }
  held_ = result == Track::kBeyondWindow;
  behind_ = result == Track::kBehind;
  switch (result) {
    case Track::kFoundFlat:
      faults |= bit(ServoFault::kZeroGradient);
      [[fallthrough]];
    case Track::kBehind:
    case Track::kFound:
      if (plane().depth(hip_W) > 0) {
        if (behind_) faults |= bit(ServoFault::kPlaneBehind);
        renewed(hip_W, last_normal_W);
      } else {
        relocate(field_->probe(hip_W), false, faults);
      }
      return;
    case Track::kBeyondWindow:
      faults |= bit(ServoFault::kBeyondWindow);
      return;
    case Track::kLeftVolume:
      release(field_->probe(hip_W));
      return;
    case Track::kLost:
      relocate(field_->probe(hip_W), true, faults);
      return;
  }
}

// The plane is new. How fast the normal turned since the last plane says for how far the new one holds.
void HriSurface::renewed(const Vec3& hip_W, const Vec3& last_normal_W) noexcept {
  if (renewal_ticks_ == 1) return settle(hip_W);
  const double voxel_m = field_->voxel();
  // Motion of the HIP along one normal has a lateral part with respect to the other. The lateral motion is taken with
  // respect to the normal for which it is smaller.
  const Vec3 way_W = hip_W - renewed_at_W_;
  const double aside_squared =
      std::min(tangentialSquared(way_W, surface_.normal_W), tangentialSquared(way_W, last_normal_W)) /
      (voxel_m * voxel_m);
  constexpr double kTooShort = 0.05;  // shorter motions cannot tell curvature from sampling errors [voxel]
  if (aside_squared > kTooShort * kTooShort) {
    const double turned_squared = (surface_.normal_W - last_normal_W).squaredNorm();
    // The rate falls to half of the old one at most.
    const double per_turn_squared = std::min(aside_squared / turned_squared, 4 * per_turn_squared_);
    per_turn_squared_ = std::clamp(per_turn_squared, 1 / (kMostTurn * kMostTurn), 1 / (kLeastTurn * kLeastTurn));
  }
  settle(hip_W);
}

// The HIP has left the sheet, or the sheet is gone (`gone`). Looks for another surface between VHIP and HIP, and, for a
// HIP inside, outward of the HIP. If the sheet is gone, a HIP that the window does not show counts as inside: then the
// way out is sought from the VHIP, and a VHIP in the air goes on as a free tool until a window shows the HIP.
void HriSurface::relocate(const Probe& hip, bool gone, std::uint32_t& faults) noexcept {
  // Rounding may have put the VHIP in the object, so the search begins a little in front of it.
  const Probe start = field_->probe(IsoField::inFrontOf(field_->sampler(), vhip_W_, surface_.normal_W));
  const bool unseen = gone && hip.side == Side::kUnknown;
  const bool inside = unseen || hip.side == Side::kInside;
  const auto entry = field_->firstEntry(start, hip);
  if (entry && touch(*entry, hip, inside, faults)) return;
  if (unseen && start.side == Side::kOutside) {
    release(start);
    held_ = resumed_ = true;
    faults |= bit(ServoFault::kBeyondWindow);
    return;
  }
  if (inside) {  // both inside
    const Probe& from = unseen ? start : hip;
    const auto way_out = field_->firstExit(from, from.p_W + surface_.normal_W * (kOutwardSearch * field_->voxel()));
    if (way_out && touch(*way_out, hip, inside, faults)) return;
    // Over an edge the normal may turn by more than a right angle. The nearest way out may be taken, but not the one
    // that leads through the object.
    const auto aside = field_->nearestExit(from);
    if (aside && surface_.normal_W.dot(-aside->direction_W) > kMostBackward && touch(*aside, hip, inside, faults))
      return;
  }
  release(hip);
  if (inside) {
    tool_ = Tool::kLost;
    faults |= bit(ServoFault::kSurfaceLost);
  }
}

// An edit has buried the tool.
void HriSurface::takeNearestExit(const Probe& hip, std::uint32_t& faults) noexcept {
  const auto way_out = field_->nearestExit(hip);
  if (!way_out || !touch(*way_out, hip, true, faults)) return;
  faults &= ~(bit(ServoFault::kInsideObject) | bit(ServoFault::kSurfaceLost));
}

void HriSurface::release(const Probe& hip) noexcept {
  tool_ = hip.side == Side::kOutside ? Tool::kFree : Tool::kInside;
  age_ticks_ = 0;
  free_ = hip;
}

// ---- free ----

void HriSurface::moveFreely(const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const Probe hip = field_->probe(hip_W);
  if (hip.side == Side::kUnknown) {
    held_ = true;
    faults |= bit(ServoFault::kBeyondWindow);
    return;
  }
  const bool after_gap = held_;
  held_ = false;
  bool buried = std::exchange(buried_, false);
  if (after_gap && (tool_ == Tool::kFree || buried)) {
    const double longest_m = kLongestGap * field_->voxel();
    const bool near = std::exchange(resumed_, false) || (hip_W - free_.p_W).squaredNorm() <= longest_m * longest_m;
    // An edit may have come while no window showed the free point.
    if (near && tool_ == Tool::kFree) free_ = field_->probe(free_.p_W);
    buried = near && (buried || free_.side == Side::kInside);
    if (tool_ == Tool::kFree && (!near || buried)) tool_ = Tool::kInside;
  }
  if (buried && hip.side == Side::kInside) {
    faults |= bit(tool_ == Tool::kLost ? ServoFault::kSurfaceLost : ServoFault::kInsideObject);
    return takeNearestExit(hip, faults);
  }
  if (tool_ == Tool::kFree) {
    const auto entry = field_->firstEntry(free_, hip);
    if (entry && touch(*entry, hip, hip.side == Side::kInside, faults)) return;
    // Its entry lies where no window has shown it.
    if (!entry && hip.side == Side::kInside) tool_ = Tool::kInside;
  }
  if (hip.side == Side::kOutside) {
    tool_ = Tool::kFree;
    free_ = hip;
  } else if (tool_ != Tool::kFree) {
    faults |= bit(tool_ == Tool::kLost ? ServoFault::kSurfaceLost : ServoFault::kInsideObject);
  }
}

// Begins contact at an entry, if the HIP is behind the plane at the surface point nearest to it. `inside`: the HIP is
// taken to be in the object.
bool HriSurface::touch(const Entry& entry, const Probe& hip, bool inside, std::uint32_t& faults) noexcept {
  SurfacePoint surface{entry.p_W, -entry.direction_W, entry.face};
  bool flat = false;
  if (entry.face.any()) {
    surface.normal_W = field_->sampler().faceNormal(entry.face.axis, entry.face.high);
  } else {
    const Vec3 gradient_W = field_->sampler().at(entry.p_W).gradient_W;
    flat = !(gradient_W.squaredNorm() > 0) || !gradient_W.allFinite();
    if (!flat) surface.normal_W = -gradient_W.normalized();
  }
  const auto behind = [&](const SurfacePoint& s) { return s.normal_W.dot(s.p_W - hip.p_W) > 0; };
  SurfacePoint nearest = surface;
  memory_ = {};
  const Track result = flat ? Track::kLost : SurfaceTracker::follow(*field_, hip.p_W, nearest, memory_);
  if (flat || result == Track::kFoundFlat) faults |= bit(ServoFault::kZeroGradient);
  const bool found = result == Track::kFound || result == Track::kFoundFlat || result == Track::kBehind;
  if (found && behind(nearest)) {
    begin(nearest, hip.p_W);
    if (result == Track::kBehind) faults |= bit(ServoFault::kPlaneBehind);
    behind_ = result == Track::kBehind;
    settle(hip.p_W);
    return true;
  }
  // If the search strays, the plane at the entry itself still holds a HIP that is in the object. If noise turns the
  // normal of that plane away, the plane across the line from the HIP is taken.
  if (!inside) return false;
  if (!behind(surface)) surface.normal_W = (entry.p_W - hip.p_W).normalized();
  if (!behind(surface)) return false;
  begin(surface, hip.p_W);
  return true;
}

void HriSurface::begin(const SurfacePoint& surface, const Vec3& hip_W) noexcept {
  tool_ = Tool::kTouching;
  behind_ = false;
  per_turn_squared_ = 1 / (kFirstTurn * kFirstTurn);
  found_for_W_ = hip_W;
  surface_ = surface;
  settle(hip_W);
}

// The squared lateral distance for which a plane holds [m^2]. `per_turn_squared`: see the member [voxel^2].
double HriSurface::reachSquared(double per_turn_squared, double depth_m, double voxel_m) noexcept {
  const double off_m = std::max(kMostOff * depth_m, kLeastOff * voxel_m);
  return std::min(kMostTurned * kMostTurned * voxel_m * voxel_m * per_turn_squared,
                  2 * off_m * voxel_m * std::sqrt(per_turn_squared));
}

double HriSurface::planeAgeError(const PlaneAge& age) noexcept {
  const double turn = std::clamp(age.curvature_per_m * age.voxel_m, kLeastTurn, kFirstTurn);  // [rad/voxel]
  const double longest_m = std::sqrt(reachSquared(1 / (turn * turn), age.depth_m, age.voxel_m));
  return age.sag(std::min(age.way(age.n), longest_m));
}

// Begins the life of a plane: from here it holds as far as its error allows.
void HriSurface::settle(const Vec3& hip_W) noexcept {
  renewed_at_W_ = hip_W;
  age_ticks_ = 0;
  if (renewal_ticks_ == 1) return;  // it is renewed in every tick
  if (behind_ || memory_.short_of_way) {
    reach_squared_m2_ = kNoReach;
    return;
  }
  reach_squared_m2_ = reachSquared(per_turn_squared_, plane().depth(hip_W), field_->voxel());
}

}  // namespace palpate
