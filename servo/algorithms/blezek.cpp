// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/blezek.hpp"

#include <algorithm>
#include <cmath>

#include "servo/algorithms/surface_tracker.hpp"
#include "servo/safety/faults.hpp"

namespace palpate {

void BlezekSurface::reset(const Vec3&) noexcept {
  field_.forget();
  free_.reset();
  in_contact_ = edited_ = false;
}

void BlezekSurface::release(const Probe& hip) noexcept {
  in_contact_ = edited_ = false;
  free_.release(hip);
}

// The first plane is across the line from the HIP to the entry, so that the first inch does not slide.
void BlezekSurface::begin(const Entry& entry, const Vec3& hip_W) noexcept {
  in_contact_ = true;
  vhip_W_ = entry.p_W;
  const Vec3 line_W = entry.p_W - hip_W;
  const double length_m = line_W.norm();
  normal_W_ = length_m > 0 ? Vec3(line_W / length_m) : Vec3(-entry.direction_W);
}

BlezekSurface::Inching BlezekSurface::takeNearestExit(const IsoField& field, const Vec3& hip_W,
                                                      std::uint32_t& faults) noexcept {
  const auto way_out = field.nearestExit(field.probe(hip_W));
  if (!way_out || way_out->face.any()) return Inching::kLost;
  begin(*way_out, hip_W);
  faults = 0;
  return inchAlong(field, hip_W, faults);
}

bool BlezekSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (!window.usable()) {
    faults |= bit(ServoFault::kNoWindow);
    return false;
  }
  const IsoField& field = field_.of(window);
  if (free_.see(window.edit_version)) edited_ = true;
  if (!in_contact_) {
    const auto entry = free_.move(field, hip_W, faults);
    edited_ = false;
    if (!entry || entry->face.any()) return false;
    begin(*entry, hip_W);
  }
  std::uint32_t trouble = 0;
  Inching inching = inchAlong(field, hip_W, trouble);
  if (inching == Inching::kLost && edited_) inching = takeNearestExit(field, hip_W, trouble);
  if (inching == Inching::kBeyondWindow) {
    faults |= bit(ServoFault::kBeyondWindow);
    return false;
  }
  if (inching == Inching::kLost) {
    faults |= trouble;
    in_contact_ = edited_ = false;
    free_.lose(field.probe(hip_W), faults);
    return false;
  }
  edited_ = false;
  if (plane().depth(hip_W) > 0) return true;
  const Probe hip = field.probe(hip_W);
  if (hip.side == Side::kOutside) release(hip);
  return false;
}

BlezekSurface::Inching BlezekSurface::inchAlong(const IsoField& field, const Vec3& hip_W,
                                                std::uint32_t& faults) noexcept {
  const double h_m = field.voxel();
  const double inch_m = kInch * h_m;
  Vec3 x_W = vhip_W_;
  const auto slide = [&](const Vec3& aside_W) {  // gives the way's length in inches, at least 1
    const double squared_m2 = aside_W.squaredNorm();
    const double inches = squared_m2 <= inch_m * inch_m ? 1 : std::sqrt(squared_m2) / inch_m;
    x_W += inches == 1 ? aside_W : Vec3(aside_W / inches);
    return inches;
  };
  const Vec3 way_W = hip_W - x_W;
  const double way_inches = slide(way_W - normal_W_ * normal_W_.dot(way_W));
  const int most = static_cast<int>(std::min<double>(kMaxInches, kSettleInches - 1 + way_inches));

  const double on_surface_m2 = kOnSurface * kOnSurface * h_m * h_m;
  SurfacePoint best;
  double best_m2 = h_m * h_m;
  const auto settle = [&] {
    if (best.normal_W.isZero(0)) return false;
    vhip_W_ = best.p_W;
    normal_W_ = best.normal_W;
    return true;
  };
  for (int inch = 1;; ++inch) {
    const Fetch f = field.sampler().at(x_W);
    if (f.place == Place::kBeyondWindow) {
      settle();  // to the edge of the window, so that the next window is placed nearer
      return Inching::kBeyondWindow;
    }
    if (f.place == Place::kBeyondVolume) return Inching::kLost;
    const double steepness_squared = f.gradient_W.squaredNorm();
    if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
      faults |= bit(ServoFault::kZeroGradient);
      return Inching::kLost;
    }
    const double per_squared = 1 / steepness_squared;
    const double excess = f.density - field.isovalue();
    const double climb_m2 = excess * excess * per_squared;  // squared length of the Newton step
    if (!std::isfinite(climb_m2)) return Inching::kLost;
    const double per_steepness = std::sqrt(per_squared);  // runs beside what follows
    x_W -= f.gradient_W * (climb_m2 <= h_m * h_m ? excess * per_squared : std::copysign(h_m * per_steepness, excess));

    const Vec3 line_W = x_W - hip_W;
    const double along = f.gradient_W.dot(line_W) * per_squared;
    const Vec3 aside_W = f.gradient_W * along - line_W;
    if (climb_m2 <= best_m2) {
      best = {x_W, f.gradient_W * -per_steepness, {}};
      best_m2 = std::max(climb_m2, on_surface_m2);
      // A HIP on the surface gives a line without length or direction, so the line counts as a tenth of a voxel at
      // least. For a HIP far below the surface the line counts as kLongestLever at most: the miss of a long line would
      // turn the normal by more than the angle itself.
      const double lever_m2 =
          std::clamp(along * along * steepness_squared, 0.01 * h_m * h_m, kLongestLever * kLongestLever * h_m * h_m);
      const bool aligned = aside_W.squaredNorm() <= kAlignment * kAlignment * lever_m2;
      if (aligned && climb_m2 <= on_surface_m2) break;
    }
    if (inch >= most) break;
    slide(aside_W);
  }
  return settle() ? Inching::kThere : Inching::kLost;
}

}  // namespace palpate
