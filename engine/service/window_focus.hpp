// SPDX-License-Identifier: Apache-2.0
// engine/service/window_focus.hpp: the point around which the next window is gathered.
//
// In contact this is the surface point, however deep the tool presses, since the servo works at the surface. In free
// motion it is where the tool will be when the window arrives. Frame W [m]. Thread: any. Cost: a few multiplications.
#pragma once

#include "servo/window/tool_pose.hpp"

namespace palpate {

inline constexpr double kWindowLead_s = 5e-3;  // about the time that a slow device takes to gather a window

// The longest lead of a window with this edge [voxel]: six voxels for 32, small enough that the tool stays inside.
// Where a new window is gathered the tool is at most this and recentreVoxels() from its middle, six sixteenths of the
// edge.
[[nodiscard]] constexpr double longestWindowLead(int edge) noexcept {
  return 3.0 * edge / 16;
}

[[nodiscard]] inline Vec3 windowFocus(const ToolPose& tool, double longest_m) noexcept {
  if (tool.at_surface) return tool.surface_W;
  const Vec3 lead_W = tool.velocity_W * kWindowLead_s;
  const double length_m = lead_W.norm();
  return tool.position_W + (length_m > longest_m ? Vec3(lead_W * (longest_m / length_m)) : lead_W);
}

}  // namespace palpate
