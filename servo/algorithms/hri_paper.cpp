// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/hri_paper.hpp"

#include <cmath>

#include "servo/safety/faults.hpp"

namespace palpate {

void HriPaper::reset(const Vec3& hip_W) noexcept {
  vhip_W_ = hip_W;
  has_plane_ = false;
  c_ = 0;
  age_ticks_ = 0;
}

// p = LinearInterpolation(VHIP, HIP, tau); N = SurfaceNormal(p).
void HriPaper::makePlane(const WindowSampler& sampler, const Fetch& at_vhip, const Fetch& at_hip, const Vec3& hip_W,
                         std::uint32_t& faults) noexcept {
  has_plane_ = false;
  const double t =
      std::isinf(at_vhip.density) ? 1.0 : (parameters_.isovalue - at_vhip.density) / (at_hip.density - at_vhip.density);
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
void HriPaper::updatePlane(const SampleWindow& window, const Vec3& hip_W, std::uint32_t& faults) noexcept {
  const double tau = parameters_.isovalue;
  if (has_plane_) {
    ++age_ticks_;
    if (c_ < parameters_.plane_renewal_ticks) {
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

// The second half of Figure 2.
void HriPaper::tick(const TickInput& in, TickOutput& out) noexcept {
  out = TickOutput{};
  if (in.window->usable()) {
    updatePlane(*in.window, in.hip_W, out.faults);
  } else {
    has_plane_ = false;
    out.faults |= bit(ServoFault::kNoWindow);
  }
  vhip_W_ = in.hip_W;
  const double depth_m = has_plane_ ? normal_W_.dot(p_W_ - in.hip_W) : 0.0;
  if (depth_m > 0) {
    vhip_W_ = in.hip_W + depth_m * normal_W_;
    out.force_W =
        (parameters_.stiffness_N_per_m * depth_m - parameters_.damping_Ns_per_m * normal_W_.dot(in.hip_velocity_W)) *
        normal_W_;
    out.normal_W = normal_W_;
    out.in_contact = true;
  }
  out.vhip_W = vhip_W_;
  out.plane_age_ticks = has_plane_ ? age_ticks_ : 0;
}

}  // namespace palpate
