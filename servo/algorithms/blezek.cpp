// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/blezek.hpp"

#include <algorithm>
#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void BlezekSurface::reset(const Vec3&) noexcept {
  field_.forget();
  free_.reset();
  in_contact_ = false;
}

void BlezekSurface::release(const Probe& hip) noexcept {
  in_contact_ = false;
  free_.release(hip);
}

bool BlezekSurface::comeOut(const IsoField& field, const Probe& hip, std::uint32_t& faults) noexcept {
  const auto way_out = field.nearestExit(hip);
  if (!way_out || way_out->face.any()) return false;
  vhip_W_ = way_out->p_W;
  faults = 0;
  return inchAlong(field, hip.p_W, faults);
}

bool BlezekSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (!window.usable()) {
    faults |= bit(ServoFault::kNoWindow);
    return false;
  }
  const IsoField& field = field_.of(window);
  if (in_contact_ && field.sampler().place(hip_W) == Place::kBeyondWindow) {
    faults |= bit(ServoFault::kBeyondWindow);
    return false;
  }
  const bool edited = free_.see(window.edit_version);
  if (!in_contact_) {
    const auto entry = free_.move(field, hip_W, faults);
    if (!entry || entry->face.any()) return false;
    vhip_W_ = entry->p_W;
    in_contact_ = true;
  }
  std::uint32_t trouble = 0;
  if (!inchAlong(field, hip_W, trouble)) {
    const Probe hip = field.probe(hip_W);
    if (!edited || !comeOut(field, hip, trouble)) {
      faults |= trouble | bit(ServoFault::kSurfaceLost);
      release(hip);
      return false;
    }
  }
  if (plane().depth(hip_W) > 0) return true;
  release(field.probe(hip_W));
  return false;
}

bool BlezekSurface::inchAlong(const IsoField& field, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const double h_m = field.voxel();
  Vec3 x_W = vhip_W_;
  for (int inch = 0;; ++inch) {
    const Fetch f = field.sampler().at(x_W);
    if (f.place != Place::kInside) return false;
    const double steepness_squared = f.gradient_W.squaredNorm();
    if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
      faults |= bit(ServoFault::kZeroGradient);
      return false;
    }
    // No roots but the normal's at the end: lengths are compared by their squares, in units of density.
    const double excess = f.density - field.isovalue();
    const double voxel_squared = h_m * h_m * steepness_squared;  // a voxel's worth of density, squared
    if (!(excess * excess <= voxel_squared)) return false;
    const double per_squared = 1 / steepness_squared;
    x_W -= f.gradient_W * (excess * per_squared);

    const Vec3 line_W = x_W - hip_W;
    const double along = f.gradient_W.dot(line_W) * per_squared;
    const Vec3 aside_W = line_W - f.gradient_W * along;
    const double aside_squared_m2 = aside_W.squaredNorm();
    // On the surface the line has no length, and no direction: an angle counts from a tenth of a voxel on.
    const double lever_squared_m2 = std::max(along * along * steepness_squared, 0.01 * h_m * h_m);
    const bool aligned = aside_squared_m2 <= kAlignment * kAlignment * lever_squared_m2;
    const bool on_surface = excess * excess <= kOnSurface * kOnSurface * voxel_squared;
    if ((aligned && on_surface) || inch == kMaxInches) {
      normal_W_ = f.gradient_W / -std::sqrt(steepness_squared);
      break;
    }
    const double longest_m = kInch * h_m;
    const bool near = aside_squared_m2 <= longest_m * longest_m;
    x_W -= near ? aside_W : Vec3(aside_W * (longest_m / std::sqrt(aside_squared_m2)));
  }
  vhip_W_ = x_W;
  return true;
}

}  // namespace palpate
