// SPDX-License-Identifier: Apache-2.0
#include "apps/path/surface_search.hpp"

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
}

TEST(SurfaceSearch, FreeDistanceEndsAtTheNextWall) {
  const AnalyticField hole(slabWithHole, 30e-3, kVoxel_m);
  const SurfaceHit wall{Vec3(5e-3, 0, 5e-3), -Vec3::UnitX()};
  EXPECT_NEAR(freeDistance(hole, wall, -Vec3::UnitX(), 30e-3), 10e-3, kVoxel_m);
  EXPECT_EQ(freeDistance(hole, wall, -Vec3::UnitX(), 6e-3), 6e-3);
}

}  // namespace surface_search_test
}  // namespace palpate
