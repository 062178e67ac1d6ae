// SPDX-License-Identifier: Apache-2.0
// The point nearest to the HIP in front of several planes, against closed forms.
//
// Tolerances. The softness s = 1e-10 leaves an active plane violated by s times its push, and pushes here are below
// 0.1 m / sin^2(angle): below 1e-9 m for angles above 0.1 rad. Roundings of positions below 0.1 m: 1e-16 m, times 1/s
// in the direction that planes without room leave open, cancelled again to below 1e-9 m.
#include "servo/objects/closest_in_planes.hpp"

#include <random>

#include <gtest/gtest.h>

namespace palpate {
namespace closest_in_planes_test {

constexpr double kTolerance_m = 1e-9;
constexpr double kNoRoom_m = 1e-8;

void expectNear(const Vec3& a, const Vec3& b, double tolerance_m = kTolerance_m) {
  EXPECT_LE((a - b).norm(), tolerance_m) << a.transpose() << " is not " << b.transpose();
}

TEST(ClosestInPlanes, InFrontOfAllItIsTheHip) {
  const ContactPlane planes[] = {{Vec3::Zero(), Vec3::UnitZ(), 0}, {Vec3::Zero(), Vec3::UnitX(), 0}};
  EXPECT_EQ(closestInPlanes(planes, {1e-3, 2e-3, 3e-3}), Vec3(1e-3, 2e-3, 3e-3));
  EXPECT_EQ(closestInPlanes({}, {1e-3, 2e-3, -3e-3}), Vec3(1e-3, 2e-3, -3e-3));
}

TEST(ClosestInPlanes, BehindOneItIsItsFoot) {
  const ContactPlane planes[] = {{{0, 0, 1e-3}, Vec3::UnitZ(), 0}, {Vec3::Zero(), Vec3::UnitX(), 0}};
  expectNear(closestInPlanes({planes, 1}, {1e-3, 2e-3, -3e-3}), {1e-3, 2e-3, 1e-3});
  expectNear(closestInPlanes(planes, {1e-3, 2e-3, -3e-3}), {1e-3, 2e-3, 1e-3});
}

// A plane yields by kPlaneSoftness of what it is pushed, so the tool stays behind it: 0.4 and 0.3 pm here.
TEST(ClosestInPlanes, APlaneYieldsToThePush) {
  const ContactPlane planes[] = {{{0, 0, 1e-3}, Vec3::UnitZ(), 0}, {Vec3::Zero(), Vec3::UnitX(), 0}};
  const Vec3 alone_W = closestInPlanes({planes, 1}, {1e-3, 2e-3, -3e-3});
  EXPECT_NEAR(planes[0].depth(alone_W), 4e-3 * kPlaneSoftness, 1e-17);
  const Vec3 both_W = closestInPlanes(planes, {-3e-3, 2e-3, -3e-3});
  EXPECT_NEAR(planes[0].depth(both_W), 4e-3 * kPlaneSoftness, 1e-17);
  EXPECT_NEAR(planes[1].depth(both_W), 3e-3 * kPlaneSoftness, 1e-17);
}

TEST(ClosestInPlanes, TwoPlanesHoldItOnTheirLine) {
  const ContactPlane planes[] = {{{0, 0, 1e-3}, Vec3::UnitZ(), 0}, {{-1e-3, 0, 0}, Vec3::UnitX(), 0}};
  expectNear(closestInPlanes(planes, {-4e-3, 2e-3, -3e-3}), {-1e-3, 2e-3, 1e-3});
}

TEST(ClosestInPlanes, ThreePlanesHoldItInTheirCorner) {
  const ContactPlane planes[] = {
      {{0, 0, 1e-3}, Vec3::UnitZ(), 0}, {{-1e-3, 0, 0}, Vec3::UnitX(), 0}, {{0, 2e-3, 0}, Vec3::UnitY(), 0}};
  expectNear(closestInPlanes(planes, {-4e-3, -2e-3, -3e-3}), {-1e-3, 2e-3, 1e-3});
}

// Two planes through the y-axis, opening upwards by 2 a: behind both, the nearest point is on the axis as long as the
// HIP is in the cone of their inward normals, otherwise it is the foot on one of them.
TEST(ClosestInPlanes, AWedgeOfAnyAngle) {
  for (const double a : {0.1, 0.5, 1.0, 1.5}) {
    const Vec3 left(std::cos(a), 0, std::sin(a));  // of the plane that rises to the left
    const Vec3 right(-std::cos(a), 0, std::sin(a));
    const ContactPlane planes[] = {{Vec3::Zero(), left, 0}, {Vec3::Zero(), right, 0}};
    expectNear(closestInPlanes(planes, {0, 1e-3, -2e-3}), {0, 1e-3, 0});
    expectNear(closestInPlanes(planes, -2e-3 * left - 1e-3 * right), Vec3::Zero());
    // On the left plane, 3 mm up its slope, and 1 mm behind it there.
    const Vec3 slope(-std::sin(a), 0, std::cos(a));
    expectNear(closestInPlanes(planes, 3e-3 * slope - 1e-3 * left), 3e-3 * slope);
  }
}

TEST(ClosestInPlanes, TheSamePlaneTwiceIsOne) {
  const ContactPlane plane{{0, 0, 1e-3}, Vec3(1, 2, 3).normalized(), 0};
  const ContactPlane planes[] = {plane, plane, plane};
  const Vec3 hip_W(1e-3, 2e-3, -9e-3);
  expectNear(closestInPlanes(planes, hip_W), plane.nearest(hip_W));
}

// No room: z >= 1 mm and z <= -1 mm. Half way between, wherever the HIP is.
TEST(ClosestInPlanes, OpposedPlanesWithoutRoomShareTheViolation) {
  const ContactPlane planes[] = {{{0, 0, 1e-3}, Vec3::UnitZ(), 0}, {{0, 0, -1e-3}, -Vec3::UnitZ(), 0}};
  for (const double z_m : {-5e-3, 0.0, 0.3e-3, 5e-3})
    expectNear(closestInPlanes(planes, {2e-3, 1e-3, z_m}), {2e-3, 1e-3, 0}, kNoRoom_m);
}

// And three planes around nothing: a triangular prism turned inside out. The centre of its circle violates all alike,
// which is the least sum of squares by symmetry.
TEST(ClosestInPlanes, ThreePlanesWithoutRoomToo) {
  ContactPlane planes[3];
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0943951023931953 * i;
    const Vec3 n(std::cos(angle), 0, std::sin(angle));
    planes[i] = {1e-3 * n, n, 0};
  }
  expectNear(closestInPlanes(planes, {0.2e-3, 4e-3, -0.1e-3}), {0, 4e-3, 0}, kNoRoom_m);
}

// Nearly parallel planes that cross far away: the answer stays near, and within what both demand.
TEST(ClosestInPlanes, NearlyParallelPlanesAreNoTrouble) {
  for (const double a : {1e-2, 1e-4, 1e-6, 1e-9, 0.0}) {
    const ContactPlane planes[] = {{Vec3::Zero(), Vec3::UnitZ(), 0},
                                   {Vec3::Zero(), Vec3(std::sin(a), 0, std::cos(a)), 0}};
    const Vec3 x_W = closestInPlanes(planes, {0, 0, -1e-3});
    expectNear(x_W, Vec3::Zero(), 1e-3 * a + kTolerance_m);
    for (const ContactPlane& plane : planes) EXPECT_LE(plane.depth(x_W), kTolerance_m);
  }
}

// With planes at rest neither the VHIP nor the force moves more than the HIP: the map is a proximal one (Rockafellar
// 1976). Random planes, parallel and opposed ones among them, with room and without.
TEST(ClosestInPlanes, NothingMovesMoreThanTheHip) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  for (int trial = 0; trial < 20000; ++trial) {
    ContactPlane planes[3];
    for (auto& plane : planes) plane = {1e-3 * vector(), vector().normalized(), 0};
    if (trial % 3 == 0) planes[1].normal_W = (-planes[0].normal_W + 1e-5 * number(random) * vector()).normalized();
    if (trial % 7 == 0) planes[2].normal_W = (planes[0].normal_W + 1e-7 * vector()).normalized();
    const Vec3 a_W = 3e-3 * vector();
    const Vec3 b_W = a_W + 1e-4 * vector();
    const Vec3 x_a_W = closestInPlanes(planes, a_W);
    const Vec3 x_b_W = closestInPlanes(planes, b_W);
    const double moved_m = (b_W - a_W).norm() + kNoRoom_m;
    ASSERT_LE((x_b_W - x_a_W).norm(), moved_m) << trial;
    ASSERT_LE(((x_b_W - b_W) - (x_a_W - a_W)).norm(), moved_m) << trial;
  }
}

// Six planes around a point, as the facets of a mesh's pit: their common point holds a HIP below it.
TEST(ClosestInPlanes, ManyPlanesOfAPit) {
  ContactPlane planes[6];
  for (int i = 0; i < 6; ++i) {
    const double angle = 1.0471975511965976 * i;
    planes[i] = {{1e-3, 2e-3, 3e-3}, Vec3(std::cos(angle), std::sin(angle), 1).normalized(), 0};
  }
  expectNear(closestInPlanes(planes, {1.2e-3, 2.1e-3, 1e-3}), {1e-3, 2e-3, 3e-3});
}

}  // namespace closest_in_planes_test
}  // namespace palpate
