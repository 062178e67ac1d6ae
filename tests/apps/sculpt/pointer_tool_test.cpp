// SPDX-License-Identifier: Apache-2.0
// Frames made by hand: a plane before the camera, with a hole in its middle.
#include "apps/sculpt/pointer_tool.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace pointer_tool_test {

constexpr double kPlane_m = 0.4;

// Looks along -x at the plane x = 0 from x = 0.4. Pixels right of the middle show nothing.
ViewFrame frame() {
  ViewFrame view;
  view.camera = lookAt(Vec3::Zero(), Vec3::UnitX(), kPlane_m, Vec3::UnitZ(), 40, 30, 0.8);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) {
      const Vec3 ray_W = view.camera.rayThrough(x + 0.5, y + 0.5);
      const double distance_m = kPlane_m / -ray_W.x();
      view.pixels.push_back({0, x < 20 ? static_cast<float>(distance_m) : std::numeric_limits<float>::infinity()});
    }
  }
  view.number = 1;
  return view;
}

// A float of 0.4 is off by 2e-8 at most.
TEST(PointerTool, FindsTheSurfaceUnderThePointer) {
  const ViewFrame view = frame();
  for (const double x : {0.5, 7.5, 19.5}) {
    for (const double y : {0.5, 14.5, 29.5}) {
      const auto surface_W = PointerTool::surface_W(view, x, y);
      ASSERT_TRUE(surface_W.has_value());
      EXPECT_NEAR(surface_W->x(), 0, 1e-7);
      const auto seen = view.camera.project(*surface_W);
      EXPECT_NEAR(seen->x, x, 1e-4);
      EXPECT_NEAR(seen->y, y, 1e-4);
    }
  }
  EXPECT_FALSE(PointerTool::surface_W(view, 20.5, 10).has_value());
  EXPECT_FALSE(PointerTool::surface_W(view, -0.1, 10).has_value());
  EXPECT_FALSE(PointerTool::surface_W(view, 10, 30).has_value());
  EXPECT_FALSE(PointerTool::surface_W(view, std::numeric_limits<double>::quiet_NaN(), 3).has_value());
  EXPECT_FALSE(PointerTool::surface_W({}, 10, 10).has_value());
}

TEST(PointerTool, HoversBeforeTheSurfaceAndPressesBelowIt) {
  const ViewFrame view = frame();
  PointerTool tool(1);
  const PointerReach reach{.depth_m = 3e-3, .lift_m = 5e-3};
  for (const double x : {2.5, 19.5}) {
    const Vec3 ray_W = view.camera.rayThrough(x, 8.5);
    const Vec3 surface_W = *PointerTool::surface_W(view, x, 8.5);
    EXPECT_NEAR((*tool.hip_W(view, x, 8.5, true, reach) - (surface_W + 3e-3 * ray_W)).norm(), 0, 1e-7);
    EXPECT_NEAR((*tool.hip_W(view, x, 8.5, false, reach) - (surface_W - 5e-3 * ray_W)).norm(), 0, 1e-7);
  }
}

// Beside the object it stays in the plane where it was, and never presses.
TEST(PointerTool, StaysAsFarAwayAsItWasBesideTheObject) {
  const ViewFrame view = frame();
  PointerTool tool(0.1);
  const PointerReach reach{.depth_m = 3e-3, .lift_m = 0};
  EXPECT_NEAR(tool.hip_W(view, 30.5, 8.5, true, reach)->x(), kPlane_m - 0.1, 1e-7);
  static_cast<void>(tool.hip_W(view, 5.5, 5.5, false, reach));
  EXPECT_NEAR(tool.hip_W(view, 30.5, 8.5, true, reach)->x(), 0, 1e-7);
  EXPECT_FALSE(tool.hip_W(view, 40, 8.5, true, reach).has_value());
}

}  // namespace pointer_tool_test
}  // namespace palpate
