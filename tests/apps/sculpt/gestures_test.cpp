// SPDX-License-Identifier: Apache-2.0
// Frames of input made by hand, as a mouse gives them.
#include "apps/sculpt/gestures.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace gestures_test {

// A plane at x = 0 before a camera on the +x axis, shown by a frame without holes.
class GesturesTest : public testing::Test {
 protected:
  GesturesTest() {
    frame.camera = view.camera();
    for (int y = 0; y < frame.camera.height; ++y) {
      for (int x = 0; x < frame.camera.width; ++x) {
        const Vec3 ray_W = frame.camera.rayThrough(x + 0.5, y + 0.5);
        frame.pixels.push_back({0, static_cast<float>(view.distance_m() / ray_W.dot(frame.camera.forward_W))});
      }
    }
    frame.number = 1;
  }
  ToolRequest take(const PointerInput& input) { return gestures.take(input, frame, view, brush, reach); }
  static PointerInput at(double x, double y) {
    PointerInput input;
    input.x = x;
    input.y = y;
    input.over = true;
    return input;
  }
  static SeenExtent extent() {
    SeenExtent seen{Vec3::Zero(), {}};
    for (int corner = 0; corner < 8; ++corner)
      seen.points_W.push_back(0.05 *
                              Vec3((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1));
    return seen;
  }

  Gestures gestures;
  OrbitView view{extent(), 64, 48};
  BrushChoice brush;
  PointerReach reach;
  ViewFrame frame;
};

TEST_F(GesturesTest, AStrokeLastsWhileTheLeftButtonIsHeld) {
  PointerInput input = at(10, 10);
  EXPECT_FALSE(take(input).presses);
  input.left = true;
  ToolRequest request = take(input);
  EXPECT_TRUE(request.presses);
  ASSERT_TRUE(request.begins.has_value());
  EXPECT_EQ(request.begins->brush.kind, EditKind::kRemove);
  EXPECT_EQ(request.begins->brush.radius_m, brush.radius_m);
  input.over = false;  // beyond the picture it goes on
  request = take(input);
  EXPECT_TRUE(request.presses);
  EXPECT_FALSE(request.begins.has_value());
  input.left = false;
  request = take(input);
  EXPECT_TRUE(request.ends);
  EXPECT_FALSE(request.presses);
  EXPECT_FALSE(take(input).ends);
}

TEST_F(GesturesTest, CtrlInvertsAndShiftSmooths) {
  PointerInput input = at(10, 10);
  input.left = input.ctrl = true;
  EXPECT_EQ(take(input).begins->brush.kind, EditKind::kAdd);
  take(at(10, 10));
  input.ctrl = false;
  input.shift = true;
  EXPECT_EQ(take(input).begins->brush.kind, EditKind::kSmooth);
}

// A button that came down on a panel, or was held before, begins nothing.
TEST_F(GesturesTest, NothingBeginsBesideThePicture) {
  PointerInput input = at(10, 10);
  input.over = false;
  input.left = true;
  EXPECT_FALSE(take(input).presses);
  input.over = true;
  EXPECT_FALSE(take(input).presses);
  input.left = false;
  take(input);
  input.left = true;
  EXPECT_TRUE(take(input).presses);
}

TEST_F(GesturesTest, TheRightAndTheMiddleButtonTurn) {
  for (const bool right : {true, false}) {
    const ViewAngles before = view.angles();
    PointerInput input = at(10, 10);
    (right ? input.right : input.middle) = true;
    EXPECT_FALSE(take(input).presses);
    EXPECT_EQ(gestures.kind(), Gestures::Kind::kOrbit);
    input.dx = 6;
    take(input);
    EXPECT_NEAR(std::remainder(view.angles().azimuth_rad - before.azimuth_rad, 2 * M_PI), -M_PI * 6 / 48, 1e-12);
    take(at(16, 10));
    EXPECT_EQ(gestures.kind(), Gestures::Kind::kNone);
  }
  PointerInput alt = at(10, 10);
  alt.left = alt.alt = true;
  EXPECT_FALSE(take(alt).begins.has_value());
  EXPECT_EQ(gestures.kind(), Gestures::Kind::kOrbit);
  take(alt);
  EXPECT_EQ(gestures.kind(), Gestures::Kind::kOrbit);
  take(at(10, 10));
  EXPECT_EQ(gestures.kind(), Gestures::Kind::kNone);
}

// What was grabbed stays under the pointer: the plane at the target's distance.
TEST_F(GesturesTest, ShiftMovesWhatWasGrabbed) {
  PointerInput input = at(10, 10);
  input.right = input.shift = true;
  const Vec3 grabbed_W = *PointerTool::surface_W(frame, 10, 10);
  take(input);
  EXPECT_EQ(gestures.kind(), Gestures::Kind::kPan);
  input.dx = 7;
  input.dy = -4;
  take(input);
  const auto seen = view.camera().project(grabbed_W);
  ASSERT_TRUE(seen.has_value());
  EXPECT_NEAR(seen->x, 17, 1e-3);
  EXPECT_NEAR(seen->y, 6, 1e-3);
}

TEST_F(GesturesTest, CtrlZoomsByDraggingAndTheWheelZooms) {
  PointerInput input = at(10, 10);
  input.right = input.ctrl = true;
  const double distance_m = view.distance_m();
  take(input);
  input.dy = -20;  // upwards: nearer
  take(input);
  EXPECT_NEAR(view.distance_m(), 0.9 * distance_m, 1e-9);
  take(at(10, 10));
  PointerInput wheel = at(50, 20);
  wheel.wheel = 2;
  const Vec3 under_W = *PointerTool::surface_W(frame, 50, 20);
  const auto before = view.camera().project(under_W);
  take(wheel);
  EXPECT_NEAR(view.distance_m(), 0.9 * 0.9 * 0.9 * distance_m, 1e-9);
  const auto after = view.camera().project(under_W);
  EXPECT_NEAR(after->x, before->x, 1e-6);
  wheel.over = false;
  take(wheel);
  EXPECT_NEAR(view.distance_m(), 0.9 * 0.9 * 0.9 * distance_m, 1e-9);
}

TEST_F(GesturesTest, DuringAStrokeTheWheelChangesTheDepth) {
  const double depth_m = reach.depth_m, distance_m = view.distance_m();
  PointerInput input = at(10, 10);
  input.left = true;
  take(input);
  input.wheel = 1;
  take(input);
  EXPECT_NEAR(reach.depth_m, 1.15 * depth_m, 1e-12);
  EXPECT_EQ(view.distance_m(), distance_m);
  input.wheel = 1000;
  take(input);
  EXPECT_EQ(reach.depth_m, Gestures::kMostDepth_m);
  input.wheel = -1000;
  take(input);
  EXPECT_EQ(reach.depth_m, Gestures::kLeastDepth_m);
}

TEST_F(GesturesTest, SizeAndStrengthFollowThePointerUntilAClickOrAreAsTheyWere) {
  for (const bool strength : {false, true}) {
    for (const int ending : {0, 1, 2}) {  // a click, Escape, the right button
      const BrushChoice before = brush = BrushChoice{.radius_m = 2e-3, .strength = 0.5};
      PointerInput input = at(10, 10);
      input.size_key = true;
      input.shift = strength;
      take(input);
      EXPECT_EQ(gestures.kind(), strength ? Gestures::Kind::kStrength : Gestures::Kind::kSize);
      input.size_key = false;
      input.dx = 10;
      take(input);
      EXPECT_EQ(brush.radius_m > before.radius_m, !strength);
      EXPECT_EQ(brush.strength > before.strength, strength);
      const BrushChoice changed = brush;
      input.dx = 0;
      input.left = ending == 0;
      input.cancel_key = ending == 1;
      input.right = ending == 2;
      EXPECT_FALSE(take(input).presses);
      EXPECT_EQ(gestures.kind(), Gestures::Kind::kNone);
      EXPECT_EQ(brush.radius_m, (ending == 0 ? changed : before).radius_m);
      EXPECT_EQ(brush.strength, (ending == 0 ? changed : before).strength);
      EXPECT_FALSE(take(input).presses);  // the same click is no stroke
      take(at(10, 10));
    }
  }
}

TEST_F(GesturesTest, KeysTurnToTheSidesOfThePatient) {
  const std::pair<ViewKey, Vec3> looks[] = {{ViewKey::kFront, {0, 1, 0}}, {ViewKey::kBack, {0, -1, 0}},
                                            {ViewKey::kLeft, {-1, 0, 0}}, {ViewKey::kRight, {1, 0, 0}},
                                            {ViewKey::kTop, {0, 0, -1}},  {ViewKey::kBottom, {0, 0, 1}}};
  for (const auto& [key, forward_W] : looks) {
    PointerInput input = at(10, 10);
    input.view_key = key;
    take(input);
    EXPECT_NEAR((view.camera().forward_W - forward_W).norm(), 0, 1e-9);
  }
  view.zoom(5, view.target_W());
  const double near_m = view.distance_m();
  PointerInput input = at(10, 10);
  input.view_key = ViewKey::kFit;
  take(input);
  EXPECT_GT(view.distance_m(), near_m);
}

}  // namespace gestures_test
}  // namespace palpate
