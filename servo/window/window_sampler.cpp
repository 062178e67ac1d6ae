// SPDX-License-Identifier: Apache-2.0
#include "servo/window/window_sampler.hpp"

#include <algorithm>
#include <limits>

namespace palpate {

WindowSampler::WindowSampler(const SampleWindow& window) noexcept
    : origin_W_(window.lattice.origin_W),
      A_LW_(window.lattice.spacing_m.cwiseInverse().asDiagonal() * window.lattice.R_WL.transpose()),
      R_WL_(window.lattice.R_WL),
      row_(window.size.x()),
      slice_(static_cast<std::ptrdiff_t>(window.size.x()) * window.size.y()),
      samples_(window.samples),
      smallest_spacing_m_(window.lattice.smallestSpacing()),
      cubic_((window.lattice.spacing_m.array() == smallest_spacing_m_).all()),
      window_(&window) {
  if (!window.usable()) return;
  last_L_ = (window.size - Vec3i::Ones()).cast<double>();
  // A place in the world is rounded, the more the farther it is from the origin.
  constexpr double kRoundings = 8;
  const double far = (window.lattice.origin_W.cwiseAbs().maxCoeff() / smallest_spacing_m_ + last_L_.maxCoeff());
  const double tolerance = std::max(kFaceTolerance, kRoundings * 0x1p-53 * far);
  low_ = -tolerance;
  high_L_ = last_L_.array() + tolerance;
  last_cell_ = window.size - Vec3i::Constant(2);
}

Fetch WindowSampler::beyond(const Vec3& p_L) const noexcept {
  Fetch nothing{0, Vec3::Zero(), Place::kBeyondWindow};
  if (window_ == nullptr || !window_->usable() || !p_L.allFinite()) return nothing;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (p_L[axis] < low_ && !window_->low_is_border[a]) return nothing;
    if (p_L[axis] > high_L_[axis] && !window_->high_is_border[a]) return nothing;
  }
  return {-std::numeric_limits<double>::infinity(), Vec3::Zero(), Place::kBeyondVolume};
}

Fetch fetch(const SampleWindow& window, const Vec3& p_W) noexcept {
  return WindowSampler(window).at(p_W);
}

}  // namespace palpate
