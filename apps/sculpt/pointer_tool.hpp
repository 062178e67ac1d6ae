// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/pointer_tool.hpp: a mouse as a tool in space: it follows the surface that is under the pointer.
//
// While a button is held, the tool is `depth_m` below the surface, along the ray, so that it is felt and the brush
// works. Otherwise it hovers `lift_m` before it. Beside the object it stays as far from the camera as it was last.
// Where the pointer or the view has jumped, so that the straight way there leads through the object, the tool leaps.
// World frame [m]; pixels of the picture. One thread; no heap. Cost: a look at nine pixels for each pixel of the way
// from the tool to the pointer in the picture, so at 9 (width + height) pixels a frame at the most.
#pragma once

#include <optional>

#include "apps/rig/live_view.hpp"
#include "servo/devices/pointer_path.hpp"

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
  // The same for a tool that is at `tool_W` now. It goes there straight, if it can without being deeper behind the
  // surface that is seen than kDeepest times the reach; one that does not press goes no deeper than it is. Where it
  // cannot, or where its way is not seen, it is put before the surface under the pointer, and comes down from there.
  // `grows_m`: how much its brush may have put over it.
  [[nodiscard]] std::optional<PointerTarget> follow(const ViewFrame& frame, double x, double y, bool presses,
                                                    const PointerReach& reach, const Vec3& tool_W, double grows_m);
  // Half way from where the camera was to where the tool was led last: nothing is in between. While the view turns, and
  // while the pointer is elsewhere, the tool waits there.
  [[nodiscard]] std::optional<PointerTarget> rest(const ViewFrame& frame, const Vec3& tool_W);
  // How far a place lies behind the surface that is seen, along its ray; before it: negative. Empty where the frame
  // does not show the place.
  [[nodiscard]] static std::optional<double> behind_m(const ViewFrame& frame, const Vec3& p_W);
  // A pressed tool goes over the surface in straight lines, from frame to frame; those cut a round object. Twice the
  // reach lets it go 18 mm at once on a ball of 40 mm that it presses 1 mm deep.
  static constexpr double kDeepest = 2;
  // What is under the pointer; empty: nothing.
  [[nodiscard]] static std::optional<Vec3> surface_W(const ViewFrame& frame, double x, double y);

 private:
  double distance_m_;           // along the view's axis, of what was last under the pointer
  std::optional<Vec3> last_W_;  // that was given last, not resting
  Camera last_camera_;          // of the frame that it was given for
};

}  // namespace palpate
