// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/implicit.hpp"

#include <algorithm>
#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void ImplicitSurface::reset(const Vec3&) noexcept {
  field_.forget();
  free_.reset();
  in_contact_ = edited_ = false;
}

void ImplicitSurface::release(const Probe& hip) noexcept {
  in_contact_ = edited_ = false;
  free_.release(hip);
}

bool ImplicitSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (!window.usable()) {
    faults |= bit(ServoFault::kNoWindow);
    return false;
  }
  const IsoField& field = field_.of(window);
  if (free_.see(window.edit_version)) edited_ = true;
  std::uint32_t trouble = 0;
  Tracking tracking = Tracking::kThere;
  if (in_contact_) {
    tracking = track(field, hip_W, trouble);
    if (tracking == Tracking::kLost && edited_) {
      const auto way_out = field.nearestExit(field.probe(hip_W));
      if (way_out && !way_out->face.any()) {
        trouble = 0;
        tracking = begin(field, *way_out, hip_W, trouble);
      }
    }
  } else {
    const auto entry = free_.move(field, hip_W, faults);
    edited_ = false;
    if (!entry || entry->face.any() || free_.hipSide() != Side::kInside) return false;
    in_contact_ = true;
    tracking = begin(field, *entry, hip_W, trouble);
  }
  if (tracking == Tracking::kBeyondWindow) {
    faults |= bit(ServoFault::kBeyondWindow);
    return false;
  }
  if (tracking == Tracking::kLost) {
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

ImplicitSurface::Tracking ImplicitSurface::begin(const IsoField& field, const Entry& entry, const Vec3& hip_W,
                                                 std::uint32_t& faults) noexcept {
  double residual_m = 0;
  const Tracking onto = ontoSurface(field, entry.p_W, residual_m, faults);
  return onto == Tracking::kThere ? track(field, hip_W, faults) : onto;
}

// One Newton step from x.
ImplicitSurface::Tracking ImplicitSurface::ontoSurface(const IsoField& field, const Vec3& x_W, double& residual_m,
                                                       std::uint32_t& faults) noexcept {
  const Fetch f = field.sampler().at(x_W);
  if (f.place != Place::kInside) return f.place == Place::kBeyondWindow ? Tracking::kBeyondWindow : Tracking::kLost;
  const double steepness_squared = f.gradient_W.squaredNorm();
  if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
    faults |= bit(ServoFault::kZeroGradient);
    return Tracking::kLost;
  }
  const double steepness = std::sqrt(steepness_squared);
  const double excess = f.density - field.isovalue();
  residual_m = excess / steepness;  // depth of x below the surface
  if (!std::isfinite(residual_m)) return Tracking::kLost;
  normal_W_ = f.gradient_W / -steepness;
  // A whole step needs no square root; only a step that is cut short uses the normal.
  if (std::abs(residual_m) <= field.voxel()) {
    p_W_ = x_W - f.gradient_W * (excess / steepness_squared);
  } else {
    p_W_ = x_W + normal_W_ * std::clamp(residual_m, -field.voxel(), field.voxel());
  }
  return Tracking::kThere;
}

ImplicitSurface::Tracking ImplicitSurface::track(const IsoField& field, const Vec3& hip_W,
                                                 std::uint32_t& faults) noexcept {
  const double h_m = field.voxel();
  Vec3 best_W = p_W_;
  Vec3 best_normal_W = normal_W_;
  double best_m = h_m;
  for (int pass = 1;; ++pass) {
    const Vec3 aside_W = plane().nearest(hip_W) - p_W_;
    const double squared_m2 = aside_W.squaredNorm();
    const bool whole = squared_m2 <= h_m * h_m;
    const Vec3 move_W = whole ? aside_W : Vec3(aside_W * (h_m / std::sqrt(squared_m2)));
    double residual_m = 0;
    const Tracking onto = ontoSurface(field, p_W_ + move_W, residual_m, faults);
    if (onto != Tracking::kThere) return onto;
    const double off_m = std::abs(residual_m);
    const bool settled = squared_m2 <= kSettled * kSettled * h_m * h_m || pass >= kSettlePasses;
    if (off_m <= kUsable * h_m && whole && settled && pass >= kPasses) return Tracking::kThere;
    if (off_m <= best_m) {
      best_W = p_W_;
      best_normal_W = normal_W_;
      best_m = std::max(off_m, kUsable * h_m);
    }
    if (pass == kMaxPasses) break;
  }
  if (best_m >= h_m) return Tracking::kLost;
  p_W_ = best_W;
  normal_W_ = best_normal_W;
  return Tracking::kThere;
}

}  // namespace palpate
