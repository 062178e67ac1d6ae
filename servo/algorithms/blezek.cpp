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

void BlezekSurface::release(const Probe& hip, std::uint64_t edit_version) noexcept {
  in_contact_ = false;
  free_.release(hip, edit_version);
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
  if (!in_contact_) {
    const auto entry = free_.move(field, window.edit_version, hip_W, faults);
    if (!entry || entry->face.any()) return false;
    vhip_W_ = entry->p_W;
    in_contact_ = true;
  }
  switch (inchAlong(field, hip_W, faults)) {
    case Inching::kDone:
      break;
    case Inching::kBeyondWindow:
      faults |= bit(ServoFault::kBeyondWindow);
      return false;
    case Inching::kLost:
      faults |= bit(ServoFault::kSurfaceLost);
      release(field.probe(hip_W), window.edit_version);
      return false;
  }
  if (plane().depth(hip_W) > 0) return true;
  release(field.probe(hip_W), window.edit_version);
  return false;
}

BlezekSurface::Inching BlezekSurface::inchAlong(const IsoField& field, const Vec3& hip_W,
                                                std::uint32_t& faults) noexcept {
  const double h_m = field.voxel();
  Vec3 x_W = vhip_W_;
  for (int inch = 0;; ++inch) {
    const Fetch f = field.sampler().at(x_W);
    if (f.place == Place::kBeyondWindow) return Inching::kBeyondWindow;
    if (f.place == Place::kBeyondVolume) return Inching::kLost;
    const double steepness_squared = f.gradient_W.squaredNorm();
    if (!(steepness_squared > 0) || !std::isfinite(steepness_squared)) {
      faults |= bit(ServoFault::kZeroGradient);
      return Inching::kLost;
    }
    const double per_steepness = 1 / std::sqrt(steepness_squared);
    const double residual_m = (f.density - field.isovalue()) * per_steepness;  // depth of x below the surface
    if (!(std::abs(residual_m) <= h_m)) return Inching::kLost;
    normal_W_ = f.gradient_W * -per_steepness;
    x_W += normal_W_ * residual_m;

    const Vec3 line_W = x_W - hip_W;
    const double depth_m = normal_W_.dot(line_W);
    const Vec3 aside_W = line_W - depth_m * normal_W_;
    const double aside_squared_m2 = aside_W.squaredNorm();
    // On the surface the line has no length, and no direction: an angle counts from a tenth of a voxel on.
    const double lever_m = std::max(std::abs(depth_m), 0.1 * h_m);
    const bool aligned = aside_squared_m2 <= kAlignment * kAlignment * lever_m * lever_m;
    if ((aligned && std::abs(residual_m) <= kOnSurface * h_m) || inch == kMaxInches) break;
    const double longest_m = kInch * h_m;
    const bool near = aside_squared_m2 <= longest_m * longest_m;
    x_W -= near ? aside_W : Vec3(aside_W * (longest_m / std::sqrt(aside_squared_m2)));
  }
  vhip_W_ = x_W;
  return Inching::kDone;
}

}  // namespace palpate
