// SPDX-License-Identifier: Apache-2.0
// engine/service/window_focus.hpp: the point around which the next window is gathered.
//
// In contact this is the surface point, however deep the tool presses, since the servo works at the surface. In free
// motion it is where the tool will be when the window arrives. Frame W [m]. Thread: any. Cost: a few multiplications.
#pragma once

#include "servo/window/tool_pose.hpp"

namespace palpate {

inline constexpr double kWindowLead_s = 5e-3;      // about the time that a slow device takes to gather a window
inline constexpr double kMaxWindowLead_voxel = 6;  // small enough that the tool stays inside the window

// `voxel_m`: the volume's smallest spacing.
[[nodiscard]] inline Vec3 windowFocus(const ToolPose& tool, double voxel_m) noexcept {
  if (tool.at_surface) return tool.surface_W;
  const Vec3 lead_W = tool.velocity_W * kWindowLead_s;
  const double longest_m = kMaxWindowLead_voxel * voxel_m;
  const double length_m = lead_W.norm();
  return tool.position_W + (length_m > longest_m ? Vec3(lead_W * (longest_m / length_m)) : lead_W);
}

}  // namespace palpate
