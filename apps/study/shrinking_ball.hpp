// SPDX-License-Identifier: Apache-2.0
// apps/study/shrinking_ball.hpp: a ball whose surface recedes evenly, as under a drill, so that a window of samples is
// wrong by exactly as much as it is old. And a tool that slides over the surface as it is now.
//
// World frame W [m]; the ball's centre is the origin. Samples lie at whole multiples of the voxel. Density is linear in
// the distance from the surface, within a ramp of three voxels on either side, as in the phantoms; gradients are
// central differences, as the engine's. One thread. Cost of a window: some ns a sample.
#pragma once

#include <cstdint>
#include <vector>

#include "servo/window/sample_window.hpp"

namespace palpate {

struct ShrinkingBall {
  double radius_m = 20e-3;       // at first
  double speed_m_per_s = 10e-3;  // with which the surface recedes
  double voxel_m = 0.5e-3;
  [[nodiscard]] double radiusAt_m(double t_s) const { return radius_m - speed_m_per_s * t_s; }
};

inline constexpr double kBallContrast = 1000;  // of the ball over the isovalue, and of the isovalue over the air

// The window of edge^3 samples around a place, as the ball is at `t_s`. The samples live in `storage`; `version` of the
// volume and of the window, since every window holds another ball.
[[nodiscard]] SampleWindow windowOf(const ShrinkingBall& ball, double t_s, const Vec3& place_W, int edge,
                                    std::uint64_t version, std::vector<Sample>& storage);

// Where the tool is: it comes from 1.5 mm outside to `depth_m` below the surface within a tenth of a second, and slides
// along a great circle from the beginning.
struct BallTool {
  double speed_m_per_s = 0.1;  // along the surface
  double depth_m = 1e-3;
  Vec3 towards = Vec3(0.6, 0.64, 0.48), aside = Vec3(0.8, -0.48, -0.36);  // unit, at right angles
  static constexpr double kApproach_s = 0.1, kAir_m = 1.5e-3;

  [[nodiscard]] double depthAt_m(double t_s) const;                             // below the surface as it is then
  [[nodiscard]] Vec3 directionAt(const ShrinkingBall& ball, double t_s) const;  // from the centre; the exact normal
  [[nodiscard]] Vec3 positionAt_W(const ShrinkingBall& ball, double t_s) const;
};

}  // namespace palpate
