// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/pointer_tool.hpp: a mouse as a tool in space: it follows the surface that is under the pointer.
//
// While a button is held, the tool is `depth_m` below the surface, along the ray, so that it is felt and the brush
// works. Otherwise it hovers `lift_m` before it. Beside the object it stays as far from the camera as it was last.
// World frame [m]; pixels of the picture. One thread; no cost.
#pragma once

#include <optional>

#include "apps/rig/live_view.hpp"

namespace palpate {

struct PointerReach {
  double depth_m = 1e-3;
  double lift_m = 2e-3;
};

class PointerTool {
 public:
  // The first place, where nothing was under the pointer yet.
  explicit PointerTool(double distance_m) : distance_m_(distance_m) {}

  // Where the HIP belongs for a pointer at (x, y). Empty where the frame has no such pixel.
  [[nodiscard]] std::optional<Vec3> hip_W(const ViewFrame& frame, double x, double y, bool presses,
                                          const PointerReach& reach);
  // Half way from the camera to where the tool was last: nothing is in between. While the view turns, and while the
  // pointer is elsewhere, the tool waits there.
  [[nodiscard]] std::optional<Vec3> resting_W(const ViewFrame& frame);
  // What is under the pointer; empty: nothing.
  [[nodiscard]] static std::optional<Vec3> surface_W(const ViewFrame& frame, double x, double y);

 private:
  double distance_m_;           // along the view's axis, of what was last under the pointer
  std::optional<Vec3> last_W_;  // that was given last, not resting
};

}  // namespace palpate
