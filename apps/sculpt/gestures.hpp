// SPDX-License-Identifier: Apache-2.0
// apps/sculpt/gestures.hpp: what a person does with mouse and keys over the picture, as in Blender's sculpt mode.
//
//   left button            a stroke; Ctrl inverts the brush, Shift smooths; the wheel changes the depth meanwhile
//   middle or right button turns the object (also Alt + left); with Shift moves it, with Ctrl zooms
//   wheel                  zooms towards what is under the pointer
//   F, Shift + F           size or strength of the brush: move, then click; Esc or right button: as it was
//   1, 3, 7                front, right, top; with Ctrl the opposite sides;  Home: all of the object
//
// A gesture that began over the picture goes on beyond it. Pixels of the picture. One thread; no cost.
#pragma once

#include <optional>

#include "apps/sculpt/brush_choice.hpp"
#include "apps/sculpt/orbit_view.hpp"
#include "apps/sculpt/pointer_tool.hpp"

namespace palpate {

enum class ViewKey { kFront, kBack, kLeft, kRight, kTop, kBottom, kFit };
// From which side; kFit: as kFront.
[[nodiscard]] ViewAngles anglesOf(ViewKey key);

// Of one frame of the window.
struct PointerInput {
  double x = 0, y = 0;                               // in the picture [pixel]
  double dx = 0, dy = 0;                             // since the last frame [pixel]
  double wheel = 0;                                  // steps, away from the person
  bool over = false;                                 // the picture, and no panel before it
  bool left = false, middle = false, right = false;  // held
  bool shift = false, ctrl = false, alt = false;
  bool size_key = false, cancel_key = false;  // pressed since the last frame
  std::optional<ViewKey> view_key = {};       // likewise
};

// What the tool shall do.
struct ToolRequest {
  bool presses = false;                      // the tool is below the surface
  std::optional<ToolBrushSpec> begins = {};  // a stroke
  bool ends = false;                         // the stroke
};

class Gestures {
 public:
  enum class Kind { kNone, kStroke, kOrbit, kPan, kZoom, kSize, kStrength };

  [[nodiscard]] ToolRequest take(const PointerInput& input, const ViewFrame& frame, OrbitView& view, BrushChoice& brush,
                                 PointerReach& reach);
  [[nodiscard]] Kind kind() const noexcept { return kind_; }

  static constexpr double kLeastDepth_m = 1e-5, kMostDepth_m = 0.05;

 private:
  void begin(const PointerInput& input, const BrushChoice& brush, ToolRequest& request);
  void move(const PointerInput& input, const ViewFrame& frame, OrbitView& view, BrushChoice& brush);
  void end(const PointerInput& input, BrushChoice& brush, ToolRequest& request);

  Kind kind_ = Kind::kNone;
  BrushChoice before_;  // of kSize and kStrength
  bool left_was_held_ = false, other_was_held_ = false;
  double pan_distance_m_ = 0;  // along the view's axis, of what is moved
};

}  // namespace palpate
