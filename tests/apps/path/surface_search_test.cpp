// SPDX-License-Identifier: Apache-2.0
#include "apps/path/surface_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "analytic_field.hpp"

namespace palpate {
namespace surface_search_test {

constexpr double kVoxel_m = 0.5e-3;
const AnalyticField kSphere([](const Vec3& p) { return sphereDistance(p, 10e-3); }, 16e-3, kVoxel_m);

TEST(SurfaceSearch, RayEntersTheSphereWhereTheFormulaSays) {
  const auto point = firstEntry(kSphere, Vec3(3e-3, 0, 20e-3), -Vec3::UnitZ(), 40e-3);
  ASSERT_TRUE(point);
  const Vec3 expected(3e-3, 0, std::sqrt(100e-6 - 9e-6));
  EXPECT_LT((point->p_W - expected).norm(), 1e-6 * kVoxel_m);
  EXPECT_LT((point->normal_W - expected.normalized()).norm(), 1e-6);
}

TEST(SurfaceSearch, HeightIsAboveTheIsovalueAndTheNormalPointsOut) {
  AnalyticField plane([](const Vec3& p) { return p.x() + 2 * p.y(); }, 16e-3, kVoxel_m);
  plane.setIsovalue(1e-3);
  EXPECT_NEAR(heightAt(plane, Vec3(4e-3, 1e-3, 0)).value(), 5e-3, 1e-15);
  EXPECT_LT((normalAt(plane, Vec3(4e-3, 1e-3, 0)).value() + Vec3(1, 2, 0).normalized()).norm(), 1e-9);
  EXPECT_FALSE(heightAt(plane, Vec3(0, 17e-3, 0)));
  EXPECT_FALSE(normalAt(plane, Vec3(0, 17e-3, 0)));
  const AnalyticField flat([](const Vec3&) { return 1.0; }, 16e-3, kVoxel_m);
  EXPECT_FALSE(normalAt(flat, Vec3::Zero()));
  EXPECT_FALSE(snapToSurface(flat, Vec3::Zero()));
}

// From a metre away and from every side: only the part of a ray in the volume matters. The reach ends a little after
// the surface, and a little before it.
TEST(SurfaceSearch, RaysFromAfarEnterWhereTheFormulaSays) {
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 direction = Vec3(octant & 1 ? 1 : -1, octant & 2 ? 2 : -2, octant & 4 ? 3 : -3).normalized();
    const auto point = firstEntry(kSphere, -direction, direction, 0.99 + 1e-6);
    ASSERT_TRUE(point) << octant;
    EXPECT_LT((point->p_W + 10e-3 * direction).norm(), 1e-9) << octant;
    EXPECT_FALSE(firstEntry(kSphere, -direction, direction, 0.99 - 1e-6)) << octant;
  }
}

// At most 60 steps of half a voxel.
TEST(SurfaceSearch, SnapsFromThirtyVoxelsAndNoFarther) {
  AnalyticField plane([](const Vec3& p) { return -p.z(); }, 50e-3, 1e-3);
  plane.setIsovalue(2e-3);
  const auto point = snapToSurface(plane, Vec3(1e-3, 2e-3, 27e-3));
  ASSERT_TRUE(point);
  EXPECT_LT((point->p_W - Vec3(1e-3, 2e-3, -2e-3)).norm(), 1e-7);
  EXPECT_FALSE(snapToSurface(plane, Vec3(1e-3, 2e-3, 29e-3)));
  EXPECT_FALSE(snapToSurface(plane, Vec3(0, 0, 51e-3)));
}

// A wall of 0.6 voxel is found wherever the steps fall, and no finer steps than half a voxel are paid for: 32 mm of way
// through the volume are 129 samples, one more or less at either end for rounding.
TEST(SurfaceSearch, RaysGoInStepsOfHalfAVoxel) {
  const AnalyticField wall([](const Vec3& p) { return 0.3 * kVoxel_m - std::abs(p.z()); }, 16e-3, kVoxel_m);
  for (int n = 0; n < 20; ++n) {
    const auto point = firstEntry(wall, Vec3(0, 0, 20e-3 + n * 0.03 * kVoxel_m), -Vec3::UnitZ(), 40e-3);
    ASSERT_TRUE(point) << n;
    EXPECT_NEAR(point->p_W.z(), 0.3 * kVoxel_m, 1e-6 * kVoxel_m) << n;
  }
  int readings = 0;
  const auto counted = [&](const Vec3&) {
    ++readings;
    return -1.0;
  };
  const AnalyticField nothing(counted, 16e-3, kVoxel_m);
  EXPECT_FALSE(firstEntry(nothing, Vec3(0, 0, 20e-3), -Vec3::UnitZ(), 40e-3));
  constexpr int kReadings = 7;  // of a sample: the density and six for the gradient
  EXPECT_NEAR(readings / kReadings, 129, 2);
}

TEST(SurfaceSearch, RayBesideTheSphereMisses) {
  EXPECT_FALSE(firstEntry(kSphere, Vec3(10.1e-3, 0, 20e-3), -Vec3::UnitZ(), 40e-3));
}

// A field that is object at its border: entering the volume is not entering the object.
TEST(SurfaceSearch, TheVolumesBorderIsNoSurface) {
  const AnalyticField cavity([](const Vec3& p) { return -sphereDistance(p, 10e-3); }, 16e-3, kVoxel_m);
  const auto point = firstEntry(cavity, Vec3(0, 0, 20e-3), -Vec3::UnitZ(), 40e-3);
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->p_W.z(), -10e-3, 1e-9);  // through the wall, across the cavity, into the far wall
}

TEST(SurfaceSearch, NearestPointOfTheSphereIsOnTheRadius) {
  for (const Vec3& from : {Vec3(2e-3, 3e-3, 4e-3), Vec3(9e-3, 9e-3, -2e-3)}) {
    const auto point = nearestSurfacePoint(kSphere, from, 20e-3);
    ASSERT_TRUE(point);
    // The sliding stops when a Newton step no longer gains; 0.01 voxel is the square root of the snap tolerance.
    EXPECT_LT((point->p_W - 10e-3 * from.normalized()).norm(), 0.01 * kVoxel_m);
  }
}

TEST(SurfaceSearch, NothingNearIsNothing) {
  EXPECT_FALSE(nearestSurfacePoint(kSphere, Vec3(15e-3, 0, 0), 4e-3));
  EXPECT_TRUE(nearestSurfacePoint(kSphere, Vec3(15e-3, 0, 0), 5.5e-3));
}

// 600 evenly spread directions leave no gap of more than 0.1 rad: a ball of 0.15 rad is met wherever it is.
TEST(SurfaceSearch, SomethingNearIsFoundInEveryDirection) {
  for (int n = 0; n < 27; ++n) {
    if (n == 13) continue;
    const Vec3i way(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    const Vec3 centre = 10e-3 * way.cast<double>().normalized();
    const AnalyticField ball([&](const Vec3& p) { return sphereDistance(p - centre, 1.5e-3); }, 16e-3, 1e-3);
    const auto point = nearestSurfacePoint(ball, Vec3::Zero(), 12e-3);
    ASSERT_TRUE(point) << n;
    EXPECT_NEAR((point->p_W - centre).norm(), 1.5e-3, 1e-6) << n;
  }
}

TEST(SurfaceSearch, FreeDistanceEndsAtTheNextWall) {
  const AnalyticField hole(slabWithHole, 30e-3, kVoxel_m);
  const SurfaceHit wall{Vec3(5e-3, 0, 5e-3), -Vec3::UnitX()};
  EXPECT_NEAR(freeDistance(hole, wall, -Vec3::UnitX(), 30e-3), 10e-3, kVoxel_m);
  EXPECT_EQ(freeDistance(hole, wall, -Vec3::UnitX(), 6e-3), 6e-3);
  // 9.9 mm in steps of a quarter of a millimetre: the last one that is free.
  EXPECT_NEAR(freeDistance(hole, {Vec3(4.9e-3, 0, 5e-3), -Vec3::UnitX()}, -Vec3::UnitX(), 30e-3), 9.75e-3, 1e-12);
}

}  // namespace surface_search_test
}  // namespace palpate
