// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri_paper.hpp"

#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void HriPaperSurface::reset(const Vec3& hip_W) noexcept {
  vhip_W_ = hip_W;
  has_plane_ = false;
  c_ = 0;
  age_ticks_ = 0;
}

// p = LinearInterpolation(VHIP, HIP, tau); N = SurfaceNormal(p).
void HriPaperSurface::makePlane(const WindowSampler& sampler, const Fetch& at_vhip, const Fetch& at_hip,
                                const Vec3& hip_W, std::uint32_t& faults) noexcept {
  has_plane_ = false;
  const double t =
      std::isinf(at_vhip.density) ? 1.0 : (isovalue_ - at_vhip.density) / (at_hip.density - at_vhip.density);
  const Vec3 p_W = vhip_W_ + t * (hip_W - vhip_W_);
  const Fetch at_p = sampler.at(p_W);
  const double steepness = at_p.gradient_W.norm();  // [density/m]
  if (at_p.place != Place::kInside || !(steepness > 0) || !std::isfinite(steepness)) {
    faults |= bit(ServoFault::kZeroGradient);
    return;
  }
  p_W_ = p_W;
  normal_W_ = at_p.gradient_W / -steepness;
  has_plane_ = true;
  age_ticks_ = 0;
}

// The first half of Figure 2.
void HriPaperSurface::updatePlane(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const double tau = isovalue_;
  if (has_plane_) {
    ++age_ticks_;
    if (c_ < n_) {
      ++c_;
      return;
    }
    c_ = 0;
  }
  const WindowSampler sampler(window);
  const Fetch at_hip = sampler.at(hip_W);
  if (at_hip.place == Place::kBeyondWindow) {
    faults |= bit(ServoFault::kBeyondWindow);
    has_plane_ = false;
    return;
  }
  if (at_hip.density <= tau) {
    has_plane_ = false;
    return;
  }
  const Fetch at_vhip = sampler.at(vhip_W_);
  if (at_vhip.place == Place::kBeyondWindow) {
    faults |= bit(ServoFault::kBeyondWindow);
    has_plane_ = false;
    return;
  }
  if (has_plane_ || at_vhip.density <= tau) makePlane(sampler, at_vhip, at_hip, hip_W, faults);
}

// The second half of Figure 2, but for the force.
bool HriPaperSurface::find(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  if (window.usable()) {
    updatePlane(window, hip_W, faults);
  } else {
    has_plane_ = false;
    faults |= bit(ServoFault::kNoWindow);
  }
  const bool touching = has_plane_ && plane().depth(hip_W) > 0;
  vhip_W_ = touching ? plane().nearest(hip_W) : hip_W;
  return touching;
}

}  // namespace palpate
