// SPDX-License-Identifier: Apache-2.0
// servo/contact/contact_plane.hpp: the virtual plane that stands for a surface near the tool (the paper, equation 1).
//
// Frame W: world [m]. Plain data.
#pragma once

#include <cstdint>

#include "base/vec.hpp"

namespace palpate {

// The longest motion of a tool in a tick. If two successive positions are farther apart, one of them is a wrong
// reading, and sums over the motion start anew [m].
inline constexpr double kLongestTickMotion_m = 0.1;

// Whether a displacement can be the motion of a tick. False for NaN too.
[[nodiscard]] inline bool isTickMotion(const Vec3& way_W) noexcept {
  return way_W.cwiseAbs().maxCoeff() <= kLongestTickMotion_m && way_W.allFinite();
}

struct ContactPlane {
  Vec3 p_W = Vec3::Zero();       // a point on the plane and on the surface [m]
  Vec3 normal_W = Vec3::Zero();  // unit, out of the object [-]
  std::int32_t age_ticks = 0;    // since it was found; 0: in this tick [tick]

  // How far x is behind the plane, along its normal; negative in front [m].
  [[nodiscard]] double depth(const Vec3& x_W) const noexcept { return normal_W.dot(p_W - x_W); }
  // The point of the plane nearest to x (the paper, equation 2) [m].
  [[nodiscard]] Vec3 nearest(const Vec3& x_W) const noexcept { return x_W + depth(x_W) * normal_W; }
};

}  // namespace palpate
