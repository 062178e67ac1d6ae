// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/implicit.hpp"

#include <algorithm>
#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void ImplicitSurface::reset(const Vec3&) noexcept {
  field_.forget();
  free_.reset();
  in_contact_ = false;
}

bool ImplicitSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (!window.usable()) {
    faults |= bit(ServoFault::kNoWindow);
    return false;
  }
  const IsoField& field = field_.of(window);
  std::uint32_t trouble = 0;
  if (in_contact_) {
    const Probe hip = field.probe(hip_W);
    if (hip.side == Side::kUnknown) {
      faults |= bit(ServoFault::kBeyondWindow);
      return false;
    }
    if (hip.side == Side::kOutside) {
      in_contact_ = false;
      free_.release(hip);
      return false;
    }
    const bool edited = free_.see(window.edit_version);
    trouble = track(field, hip_W);
    if (trouble != 0 && edited) {
      const auto way_out = field.nearestExit(hip);
      if (way_out && !way_out->face.any()) trouble = begin(field, *way_out, hip_W);
    }
  } else {
    free_.see(window.edit_version);
    const auto entry = free_.move(field, hip_W, faults);
    if (!entry || entry->face.any() || free_.hipSide() != Side::kInside) return false;
    in_contact_ = true;
    trouble = begin(field, *entry, hip_W);
  }
  faults |= trouble;
  if (trouble != 0) {
    in_contact_ = false;
    free_.release(field.probe(hip_W));
    return false;
  }
  return plane().depth(hip_W) > 0;
}

std::uint32_t ImplicitSurface::begin(const IsoField& field, const Entry& entry, const Vec3& hip_W) noexcept {
  double residual_m = 0;
  const std::uint32_t trouble = ontoSurface(field, entry.p_W, residual_m);
  return trouble != 0 ? trouble : track(field, hip_W);
}

// One Newton step from x; gives a fault or none.
std::uint32_t ImplicitSurface::ontoSurface(const IsoField& field, const Vec3& x_W, double& residual_m) noexcept {
  const Fetch f = field.sampler().at(x_W);
  if (f.place != Place::kInside) return bit(ServoFault::kSurfaceLost);
  const double steepness_squared = f.gradient_W.squaredNorm();
  if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
    return bit(ServoFault::kZeroGradient) | bit(ServoFault::kSurfaceLost);
  }
  const double steepness = std::sqrt(steepness_squared);
  const double excess = f.density - field.isovalue();
  residual_m = excess / steepness;  // depth of x below the surface
  if (!std::isfinite(residual_m)) return bit(ServoFault::kSurfaceLost);
  normal_W_ = f.gradient_W / -steepness;
  // The way of a step needs no root; only one that is cut short goes by the normal.
  if (std::abs(residual_m) <= field.voxel()) {
    p_W_ = x_W - f.gradient_W * (excess / steepness_squared);
  } else {
    p_W_ = x_W + normal_W_ * std::clamp(residual_m, -field.voxel(), field.voxel());
  }
  return 0;
}

std::uint32_t ImplicitSurface::track(const IsoField& field, const Vec3& hip_W) noexcept {
  const double h_m = field.voxel();
  double residual_m = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Vec3 aside_W = plane().nearest(hip_W) - p_W_;
    const double squared_m2 = aside_W.squaredNorm();
    const Vec3 move_W = squared_m2 <= h_m * h_m ? aside_W : Vec3(aside_W * (h_m / std::sqrt(squared_m2)));
    if (const std::uint32_t trouble = ontoSurface(field, p_W_ + move_W, residual_m); trouble != 0) return trouble;
  }
  return std::abs(residual_m) <= kUsable * h_m ? 0 : bit(ServoFault::kSurfaceLost);
}

}  // namespace palpate
