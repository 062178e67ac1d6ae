// SPDX-License-Identifier: Apache-2.0
// Plane, ball and box against their formulas. Positions are below 0.1 m, so 1e-15 m is some ten roundings.
#include "servo/objects/shapes.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "base/error.hpp"

namespace palpate {
namespace shapes_test {

constexpr double kTolerance_m = 1e-15;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void expectEntry(const std::optional<ObjectEntry>& entry, double share, const Vec3& p_W, const Vec3& normal_W) {
  ASSERT_TRUE(entry);
  EXPECT_NEAR(entry->share, share, 1e-12);
  EXPECT_LE((entry->at.p_W - p_W).norm(), kTolerance_m);
  EXPECT_LE((entry->at.normal_W - normal_W).norm(), 1e-12);
}

TEST(Plane, IsEnteredFromItsFrontOnly) {
  const PlaneObject plane({0, 0, 1e-3}, {0, 0, 2});
  expectEntry(plane.firstEntry({5e-3, 0, 2e-3}, {7e-3, 0, -2e-3}), 0.25, {5.5e-3, 0, 1e-3}, Vec3::UnitZ());
  EXPECT_FALSE(plane.firstEntry({5e-3, 0, -2e-3}, {7e-3, 0, 2e-3}));
  EXPECT_FALSE(plane.firstEntry({5e-3, 0, -2e-3}, {7e-3, 0, -3e-3}));
  EXPECT_FALSE(plane.firstEntry({5e-3, 0, 1e-3}, {7e-3, 0, 1e-3})) << "along the surface";
  EXPECT_EQ(plane.nearest({3e-3, 4e-3, -5e-3}).p_W, Vec3(3e-3, 4e-3, 1e-3));
}

// Halves and quarters, which are exact: a way that begins on the surface enters, one that ends on it does not.
TEST(Shapes, AWayEntersFromTheirSurfaceAndNotByEndingOnIt) {
  const PlaneObject plane({0, 0, 0.5}, Vec3::UnitZ());
  const SphereObject sphere(Vec3::Zero(), 0.5);
  const BoxObject box(Vec3::Zero(), Vec3::Constant(1));
  for (const ContactObject* shape :
       {static_cast<const ContactObject*>(&plane), static_cast<const ContactObject*>(&sphere),
        static_cast<const ContactObject*>(&box)}) {
    expectEntry(shape->firstEntry({0, 0, 0.5}, {0, 0, 0.25}), 0, {0, 0, 0.5}, Vec3::UnitZ());
    EXPECT_FALSE(shape->firstEntry({0, 0, 1}, {0, 0, 0.5}));
    EXPECT_FALSE(shape->firstEntry({0, 0, 1}, {0, 0, 0.75})) << "ends before it";
    expectEntry(shape->firstEntry({0, 0, 1}, {0, 0, 0.25}), 2.0 / 3, {0, 0, 0.5}, Vec3::UnitZ());
  }
}

TEST(Sphere, IsEnteredWhereTheLineMeetsIt) {
  const SphereObject sphere({1e-3, 0, 0}, 5e-3);
  // 3 mm beside the centre, the line comes in 4 mm before it.
  expectEntry(sphere.firstEntry({-9e-3, 3e-3, 0}, {11e-3, 3e-3, 0}), 0.3, {-3e-3, 3e-3, 0}, {-0.8, 0.6, 0});
  EXPECT_FALSE(sphere.firstEntry({-9e-3, 3e-3, 0}, {-4e-3, 3e-3, 0})) << "ends before it";
  EXPECT_FALSE(sphere.firstEntry({-9e-3, 6e-3, 0}, {11e-3, 6e-3, 0})) << "passes beside it";
  EXPECT_FALSE(sphere.firstEntry({2e-3, 0, 0}, {11e-3, 0, 0})) << "begins inside";
  EXPECT_FALSE(sphere.firstEntry({7e-3, 0, 0}, {11e-3, 0, 0})) << "leads away";
  const ObjectPoint nearest = sphere.nearest({1e-3, 0, -2e-3});
  EXPECT_LE((nearest.p_W - Vec3(1e-3, 0, -5e-3)).norm(), kTolerance_m);
  EXPECT_EQ(nearest.normal_W, Vec3(0, 0, -1));
  EXPECT_NEAR(sphere.nearest({1e-3, 0, 0}).normal_W.norm(), 1, 1e-15) << "at the centre any normal will do";
}

// Turned by 90 degrees about z: the box's 4 mm lie along the world's y.
TEST(Box, IsEnteredThroughTheFaceThatTheLineMeetsLast) {
  const Mat3 R_WB = Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitZ()).toRotationMatrix();
  const BoxObject box({0, 0, 1e-3}, {4e-3, 2e-3, 6e-3}, R_WB);
  expectEntry(box.firstEntry({0, 0, 8e-3}, {0, 0, 0}), 0.5, {0, 0, 4e-3}, Vec3::UnitZ());
  expectEntry(box.firstEntry({0, -4e-3, 0}, {0, 4e-3, 0}), 0.25, {0, -2e-3, 0}, -Vec3::UnitY());
  // Into the slab of x first (at 1 mm), then into that of y (at -2 mm): there it comes in.
  expectEntry(box.firstEntry({1.6e-3, -4e-3, 0}, {0, 0, 0}), 0.5, {0.8e-3, -2e-3, 0}, -Vec3::UnitY());
  EXPECT_FALSE(box.firstEntry({3e-3, -4e-3, 0}, {3e-3, 4e-3, 0})) << "passes beside it";
  EXPECT_FALSE(box.firstEntry({0, 0, 0}, {0, 0, 9e-3})) << "begins inside";
  EXPECT_FALSE(box.firstEntry({0, 0, 4e-3}, {1e-3, 0, 4e-3})) << "along a face";
  EXPECT_FALSE(box.firstEntry({0, 0, 4e-3}, {0, 0, 8e-3})) << "leads away";
  expectEntry(box.firstEntry({0, 0, 4e-3}, {0, 0, 3e-3}), 0, {0, 0, 4e-3}, Vec3::UnitZ());
}

TEST(Box, ItsNearestPointIsOnFacesEdgesAndCorners) {
  const BoxObject box(Vec3::Zero(), {2e-3, 4e-3, 6e-3});
  EXPECT_EQ(box.nearest({0.9e-3, 0, 0}).p_W, Vec3(1e-3, 0, 0)) << "from inside";
  EXPECT_EQ(box.nearest({0.9e-3, 0, 0}).normal_W, Vec3(Vec3::UnitX()));
  EXPECT_EQ(box.nearest({0, -5e-3, 0}).normal_W, Vec3(-Vec3::UnitY()));
  EXPECT_EQ(box.nearest({0, -1.9e-3, 0.5e-3}).p_W, Vec3(0, -2e-3, 0.5e-3));
  EXPECT_EQ(box.nearest({0, -1.9e-3, 0.5e-3}).normal_W, Vec3(-Vec3::UnitY()));
  EXPECT_EQ(box.nearest({0.1e-3, 0.2e-3, 2.9e-3}).p_W, Vec3(0.1e-3, 0.2e-3, 3e-3));
  EXPECT_EQ(box.nearest(Vec3::Zero()).p_W, Vec3(1e-3, 0, 0)) << "the nearest face";
  const ObjectPoint edge = box.nearest({4e-3, 6e-3, 1e-3});
  EXPECT_EQ(edge.p_W, Vec3(1e-3, 2e-3, 1e-3));
  EXPECT_LE((edge.normal_W - Vec3(0.6, 0.8, 0)).norm(), 1e-15);
}

TEST(Shapes, RefuseWhatIsNoShape) {
  EXPECT_THROW(PlaneObject({0, 0, kNaN}, Vec3::UnitZ()), Error);
  EXPECT_THROW(PlaneObject(Vec3::Zero(), Vec3::Zero()), Error);
  EXPECT_THROW(PlaneObject(Vec3::Zero(), {0, kNaN, 1}), Error);
  EXPECT_THROW(SphereObject(Vec3::Zero(), 0), Error);
  EXPECT_THROW(SphereObject(Vec3::Zero(), kNaN), Error);
  EXPECT_THROW(SphereObject(Vec3::Zero(), std::numeric_limits<double>::infinity()), Error);
  EXPECT_THROW(SphereObject({kNaN, 0, 0}, 1e-3), Error);
  EXPECT_THROW(BoxObject(Vec3::Zero(), {1e-3, 0, 1e-3}), Error);
  EXPECT_THROW(BoxObject(Vec3::Zero(), {1e-3, 1e-3, std::numeric_limits<double>::infinity()}), Error);
  EXPECT_THROW(BoxObject({0, kNaN, 0}, Vec3::Constant(1e-3)), Error);
  EXPECT_THROW(BoxObject(Vec3::Zero(), Vec3::Constant(1e-3), 2 * Mat3::Identity()), Error);
  try {
    SphereObject(Vec3::Zero(), -1, "object 3 (sphere)");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "object 3 (sphere): its radius is not positive; give a radius above 0 mm");
  }
}

}  // namespace shapes_test
}  // namespace palpate
