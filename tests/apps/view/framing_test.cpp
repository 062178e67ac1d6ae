// SPDX-License-Identifier: Apache-2.0
#include "apps/view/framing.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analytic_field.hpp"

namespace palpate {
namespace framing_test {

ContactRegion regionOnTop(double height_m) {
  ContactRegion region;
  region.centre_W = Vec3(0, 0, height_m);
  region.radius_m = 4e-3;
  region.touched = true;
  for (int i = -2; i <= 2; ++i) region.points_W.push_back(Vec3(1e-3 * i, 0, height_m));
  return region;
}

// Whether most of the region's points are seen from the camera: nothing of the object lies between.
bool seesTheGroove(const AnalyticField& field, const Camera& camera, const ContactRegion& region) {
  std::size_t seen = 0;
  for (const Vec3& p : region.points_W) {
    const Vec3 way = camera.position_W - p;
    bool hidden = false;
    for (double s = 0.5e-3; s < way.norm(); s += 0.1e-3) {
      double density = 0;
      Vec3 gradient;
      hidden = hidden || (field.sample(p + s * way.normalized(), density, gradient) && density > 0);
    }
    seen += hidden ? 0 : 1;
  }
  return 2 * seen > region.points_W.size();
}

// Samples are 44 mm / 23 apart, so a ball's box is found within that, and the radius of its sphere is sqrt(3) larger.
TEST(Framing, FindsTheObjectInTheVolume) {
  const AnalyticField ball([](const Vec3& p) { return sphereDistance(p - Vec3(5e-3, 0, 0), 10e-3); }, 22e-3, 0.5e-3);
  const ObjectBounds bounds = findObjectBounds(ball);
  const double cell_m = 44e-3 / 23;
  EXPECT_LT((bounds.centre_W - Vec3(5e-3, 0, 0)).norm(), cell_m);
  EXPECT_NEAR(bounds.radius_m, 10e-3 * std::sqrt(3.0), cell_m * std::sqrt(3.0));
}

// Samples are a millimetre apart, at -11.5 mm and so on. The outermost in this box are at -3.5 and 5.5, -0.5 and 0.5,
// -1.5 and 7.5 mm, and half a cell more is added on each side.
TEST(Framing, BoundsAreHalfACellBeyondTheOutermostSamples) {
  const AnalyticField box(
      [](const Vec3& p) { return boxDistance(p - Vec3(1e-3, 0, 3e-3), Vec3(5.2e-3, 1.2e-3, 5.2e-3)); }, 11.5e-3,
      0.5e-3);
  const ObjectBounds bounds = findObjectBounds(box);
  EXPECT_LT((bounds.centre_W - Vec3(1e-3, 0, 3e-3)).norm(), 1e-12);
  EXPECT_NEAR(bounds.radius_m, 1e-3 * std::sqrt(25.0 + 1 + 25), 1e-12);
}

// The angle of view is 30 degrees. A sphere fills the smaller side.
double distanceFor(double radius_m, double smaller_share) {
  return radius_m / std::sin(std::atan(std::tan(std::numbers::pi / 12) * smaller_share));
}

TEST(Framing, OverviewIsFromTheTouchedSideAndAQuarterTurnAround) {
  const ObjectBounds object = {Vec3(1e-3, 2e-3, 3e-3), 10e-3};
  ContactRegion region;
  region.centre_W = object.centre_W + Vec3(0, 0, 9e-3);
  const Vec3 from = Vec3(0, -0.8, 1).normalized();
  const Camera high = overviewCamera(object, region, 400, 600), wide = overviewCamera(object, region, 600, 400);
  EXPECT_LT((high.position_W - object.centre_W - distanceFor(10e-3, 400.0 / 600) * from).norm(), 1e-12);
  EXPECT_LT((wide.position_W - object.centre_W - distanceFor(10e-3, 1) * from).norm(), 1e-12);
  EXPECT_LT((wide.right_W - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_EQ(wide.width, 600);
  EXPECT_EQ(wide.height, 400);
  EXPECT_NEAR(wide.vertical_fov_rad, std::numbers::pi / 6, 1e-12);
  // The side is half the normal and half the way out: here x and z.
  region.normal_W = Vec3::UnitX();
  region.along_W = Vec3::UnitY();
  const Vec3 between = (Vec3(1, 0, 1).normalized() - 0.8 * Vec3::UnitZ()).normalized();
  const Camera mixed = overviewCamera(object, region, 600, 400);
  EXPECT_LT((mixed.forward_W + between).norm(), 1e-12);
  // Looked at from above, the picture's top is towards -y.
  region.normal_W = Vec3(0, 0.8, 1).normalized();
  region.along_W = Vec3::UnitX();
  region.centre_W = object.centre_W + 9e-3 * region.normal_W;
  const Camera above = overviewCamera(object, region, 600, 400);
  EXPECT_LT((above.forward_W + Vec3::UnitZ()).norm(), 1e-12);
  EXPECT_LT((above.up_W + Vec3::UnitY()).norm(), 1e-12);
  // A contact on the far side, with a normal inwards, has the normal alone.
  region.centre_W = object.centre_W - 9e-3 * region.normal_W;
  EXPECT_LT((overviewCamera(object, region, 600, 400).forward_W + Vec3::UnitZ()).norm(), 1e-12);
}

// Where nothing hides it, the contact is seen from 28 degrees above its plane, the slide from left to right; the camera
// looks at a point 0.15 of the radius above it.
TEST(Framing, CloseUpIsLowWhereNothingIsInTheWay) {
  const AnalyticField plane([](const Vec3& p) { return -p.z(); }, 22e-3, 0.5e-3);
  const Camera camera = closeUpCamera(plane, regionOnTop(0), 700, 500);
  const double angle = 28 * std::numbers::pi / 180;
  const Vec3 from(0, -std::cos(angle), std::sin(angle));
  EXPECT_LT((camera.position_W - Vec3(0, 0, 0.6e-3) - distanceFor(4e-3, 1) * from).norm(), 1e-12);
  EXPECT_LT((camera.right_W - Vec3::UnitX()).norm(), 1e-12);
}

TEST(Framing, OfAnEmptyVolumeIsItsBox) {
  const AnalyticField nothing([](const Vec3&) { return -1; }, 10e-3, 0.5e-3);
  EXPECT_LT(findObjectBounds(nothing).centre_W.norm(), 1e-12);
  EXPECT_NEAR(findObjectBounds(nothing).radius_m, std::sqrt(3.0) * 10e-3 * (1 + 1.0 / 23), 1e-12);  // and half a cell
}

TEST(Framing, OverviewHoldsTheWholeObject) {
  const AnalyticField ball([](const Vec3& p) { return sphereDistance(p, 15e-3); }, 22e-3, 0.5e-3);
  const Camera camera = overviewCamera(findObjectBounds(ball), regionOnTop(15e-3), 400, 600);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      const auto p = camera.project(sign * 15e-3 * Vec3::Unit(axis));
      ASSERT_TRUE(p);
      EXPECT_TRUE(p->x >= 0 && p->x <= 400 && p->y >= 0 && p->y <= 600);
    }
  }
  EXPECT_GT((camera.position_W - Vec3(0, 0, 15e-3)).z(), 0);  // from the touched side
}

TEST(Framing, CloseUpLooksObliquelyWithTheNormalUpwards) {
  const AnalyticField ball([](const Vec3& p) { return sphereDistance(p, 15e-3); }, 22e-3, 0.5e-3);
  const Camera camera = closeUpCamera(ball, regionOnTop(15e-3), 700, 500);
  const auto low = camera.project(Vec3(0, 0, 15e-3)), high = camera.project(Vec3(0, 0, 17e-3));
  ASSERT_TRUE(low && high);
  EXPECT_LT(high->y, low->y - 50);  // 2 mm along the normal are long in the picture
  const double elevation = std::asin(-camera.forward_W.z()) * 57.29578;
  EXPECT_GT(elevation, 20);
  EXPECT_LT(elevation, 80);
}

// A groove of 3 mm, 4 mm deep, along x in a block; the tool touched its end, so the contact's normals point along it.
// By symmetry across the groove, and as rays along it leave at an angle too, the open side is z; of the two ends that
// the points see unequally the normal may lean by a few degrees.
TEST(Framing, TurnsOutOfAGrooveThatTheToolHasCut) {
  const AnalyticField block(
      [](const Vec3& p) { return std::min(-p.z(), -boxDistance(p - Vec3(0, 0, 6e-3), Vec3(9e-3, 1.5e-3, 10e-3))); },
      22e-3, 0.5e-3);
  ContactRegion region = regionOnTop(-3.9e-3);
  region.normal_W = Vec3(-1, 0, 0.2).normalized();
  region.along_W = Vec3::UnitX();
  const Camera blind = closeUpCamera(block, region, 700, 500);
  turnToTheOpen(region, block);
  EXPECT_GT(region.normal_W.z(), std::cos(10 / 57.29578));
  EXPECT_NEAR(region.normal_W.norm(), 1, 1e-12);
  EXPECT_NEAR(region.along_W.dot(region.normal_W), 0, 1e-12);
  const Camera camera = closeUpCamera(block, region, 700, 500);
  EXPECT_TRUE(seesTheGroove(block, camera, region));
  EXPECT_FALSE(seesTheGroove(block, blind, regionOnTop(-3.9e-3)));
}

TEST(Framing, ARegionWithNoOpenSideStaysAsItIs) {
  const AnalyticField solid([](const Vec3&) { return 1; }, 22e-3, 0.5e-3);
  ContactRegion region = regionOnTop(0);
  region.radius_m = 2e-3;  // rays end inside
  const Vec3 before = region.normal_W;
  turnToTheOpen(region, solid);
  EXPECT_EQ(region.normal_W, before);
}

// A wall of 30 mm beside the contact, on the side from which the camera would look first.
TEST(Framing, CloseUpAvoidsTheSideThatTheObjectHides) {
  const auto walled = [](double wall_y) {
    return AnalyticField(
        [=](const Vec3& p) { return std::max(-p.z(), boxDistance(p - Vec3(0, wall_y, 0), Vec3(20e-3, 1e-3, 30e-3))); },
        32e-3, 0.5e-3);
  };
  for (const double wall_y : {-4e-3, 4e-3}) {
    const Camera camera = closeUpCamera(walled(wall_y), regionOnTop(0), 700, 500);
    EXPECT_LT(camera.position_W.y() * wall_y, 0);
  }
}

}  // namespace framing_test
}  // namespace palpate
