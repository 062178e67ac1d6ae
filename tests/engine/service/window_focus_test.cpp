// SPDX-License-Identifier: Apache-2.0
#include "engine/service/window_focus.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace window_focus_test {

TEST(WindowFocus, AToolAtRestIsTheFocus) {
  const ToolPose tool{Vec3(0.1, 0.2, 0.3), Vec3::Zero(), 7, 7};
  EXPECT_EQ(windowFocus(tool, 6e-3), tool.position_W);
}

TEST(WindowFocus, AMovingToolIsAwaitedWhereItWillBeButNoFartherThanTheWindowReaches) {
  const ToolPose slow{Vec3::Zero(), Vec3(0, 0.4, 0), 7, 7};
  EXPECT_NEAR(windowFocus(slow, 6e-3).y(), 0.4 * kWindowLead_s, 1e-15);
  const ToolPose fast{Vec3::Zero(), Vec3(0, 0, -30), 7, 7};
  EXPECT_NEAR(windowFocus(fast, 6e-3).z(), -6e-3, 1e-15);
}

TEST(WindowFocus, InContactItIsTheSurfacePoint) {
  const ToolPose deep{Vec3::Zero(), Vec3(0, 0, -30), 7, 7, true, Vec3(0, 0, 0.04)};
  EXPECT_EQ(windowFocus(deep, 6e-3), deep.surface_W);
}

}  // namespace window_focus_test
}  // namespace palpate
