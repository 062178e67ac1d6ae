// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/gestures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate {
namespace {

constexpr double kSizePerPixel = 0.01;  // of the logarithm of the radius
constexpr double kStrengthPerPixel = 0.004;
constexpr double kStepsPerPixel = 0.05;  // of a zoom by dragging
constexpr double kDepthStep = 1.15;      // factor for a step of the wheel

void turn(ViewKey key, OrbitView& view) {
  if (key == ViewKey::kFit) {
    view.fit();
  } else {
    view.turnTo(anglesOf(key));
  }
}

}  // namespace

ViewAngles anglesOf(ViewKey key) {
  constexpr double kQuarter = std::numbers::pi / 2;
  switch (key) {
    case ViewKey::kBack:
      return {2 * kQuarter, 0};
    case ViewKey::kLeft:
      return {kQuarter, 0};
    case ViewKey::kRight:
      return {-kQuarter, 0};
    case ViewKey::kTop:
      return {2 * kQuarter, kQuarter};
    case ViewKey::kBottom:
      return {0, -kQuarter};
    case ViewKey::kFront:
    case ViewKey::kFit:
      break;
  }
  return {};
}

ToolRequest Gestures::take(const PointerInput& input, const ViewFrame& frame, OrbitView& view, BrushChoice& brush,
                           PointerReach& reach) {
  ToolRequest request;
  if (input.view_key) turn(*input.view_key, view);
  if (kind_ == Kind::kNone) {
    begin(input, brush, request);
    if (kind_ == Kind::kPan) {
      const auto surface_W = PointerTool::surface_W(frame, input.x, input.y);
      const Camera camera = view.camera();
      pan_distance_m_ = surface_W ? (*surface_W - camera.position_W).dot(camera.forward_W) : 0;
    }
  } else {
    move(input, frame, view, brush);
    end(input, brush, request);
  }
  if (input.wheel != 0 && kind_ == Kind::kStroke) {
    reach.depth_m = std::clamp(reach.depth_m * std::pow(kDepthStep, input.wheel), kLeastDepth_m, kMostDepth_m);
  } else if (input.wheel != 0 && input.over) {
    view.zoom(input.wheel, PointerTool::surface_W(frame, input.x, input.y).value_or(view.target_W()));
  }
  request.presses = kind_ == Kind::kStroke;
  left_was_held_ = input.left;
  other_was_held_ = input.middle || input.right;
  return request;
}

// A button that was held before it came over the picture begins nothing.
void Gestures::begin(const PointerInput& input, const BrushChoice& brush, ToolRequest& request) {
  if (!input.over) return;
  const bool left = input.left && !left_was_held_, other = (input.middle || input.right) && !other_was_held_;
  if (input.size_key) {
    kind_ = input.shift ? Kind::kStrength : Kind::kSize;
    before_ = brush;
  } else if (other || (left && input.alt)) {
    kind_ = input.shift ? Kind::kPan : input.ctrl ? Kind::kZoom : Kind::kOrbit;
  } else if (left) {
    kind_ = Kind::kStroke;
    request.begins = toolBrush(brush, {.inverts = input.ctrl, .smooths = input.shift});
  }
}

void Gestures::move(const PointerInput& input, const ViewFrame&, OrbitView& view, BrushChoice& brush) {
  switch (kind_) {
    case Kind::kOrbit:
      return view.orbit(input.dx, input.dy);
    case Kind::kPan:
      return view.pan(input.dx, input.dy, pan_distance_m_);
    case Kind::kZoom:
      return view.zoom(-kStepsPerPixel * input.dy, view.target_W());
    case Kind::kSize:
      return brush.scaleRadius(std::exp(kSizePerPixel * input.dx));
    case Kind::kStrength:
      return brush.addStrength(kStrengthPerPixel * input.dx);
    case Kind::kNone:
    case Kind::kStroke:
      return;
  }
}

void Gestures::end(const PointerInput& input, BrushChoice& brush, ToolRequest& request) {
  if (kind_ == Kind::kSize || kind_ == Kind::kStrength) {
    const bool cancelled = input.cancel_key || (input.right && !other_was_held_);
    if (cancelled) brush = before_;
    if (cancelled || (input.left && !left_was_held_)) kind_ = Kind::kNone;
    return;
  }
  if (kind_ == Kind::kStroke) {
    if (input.left) return;
    request.ends = true;
  } else if (input.middle || input.right || (input.left && left_was_held_)) {
    return;
  }
  kind_ = Kind::kNone;
}

}  // namespace palpate
