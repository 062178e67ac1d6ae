// SPDX-License-Identifier: Apache-2.0
#include "apps/study/surface_offsets.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "apps/bench/random.hpp"

namespace palpate {
namespace surface_offsets_test {

constexpr double kVoxel_m = 2e-3;

reference::DenseField fieldOf(int edge, const std::function<double(const Vec3&)>& density) {
  reference::DenseField field{Vec3i::Constant(edge), {}, {}};
  field.lattice.spacing_m = Vec3::Constant(kVoxel_m);
  field.lattice.origin_W = Vec3::Constant(-0.5 * (edge - 1) * kVoxel_m);
  for (int k = 0; k < edge; ++k) {
    for (int j = 0; j < edge; ++j) {
      for (int i = 0; i < edge; ++i) {
        field.values.push_back(static_cast<float>(density(field.lattice.toWorld(Vec3(i, j, k)))));
      }
    }
  }
  return field;
}

// A linear field is exact under trilinear interpolation, so the offset is that of the planes, but for floats: 1e-7 of
// some 10 voxels.
TEST(SurfaceOffsets, OfAShiftedPlaneIsTheShift) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 normal_W = random.direction();
    const double shift_m = random.uniform(-3.5, 3.5) * kVoxel_m;
    const auto field = fieldOf(24, [&](const Vec3& p_W) { return (shift_m - normal_W.dot(p_W)) / kVoxel_m; });
    std::vector<ExactSurfacePoint> points;
    for (int i = 0; i < 20; ++i) {
      const Vec3 aside_W = random.uniform(0, 4 * kVoxel_m) * normal_W.unitOrthogonal();
      points.push_back({aside_W, normal_W});
    }
    const SurfaceOffsets offsets = surfaceOffsets(field, 0, points);
    EXPECT_EQ(offsets.lost, 0U);
    EXPECT_NEAR(offsets.mean_m, shift_m, 1e-5 * kVoxel_m);
    EXPECT_NEAR(offsets.rms_m, std::abs(shift_m), 1e-5 * kVoxel_m);
  }
}

TEST(SurfaceOffsets, ASurfaceFartherThanFourVoxelsIsLost) {
  const auto field = fieldOf(24, [&](const Vec3& p_W) { return 5 - p_W.x() / kVoxel_m; });
  const SurfaceOffsets offsets =
      surfaceOffsets(field, 0, std::vector<ExactSurfacePoint>{{Vec3::Zero(), Vec3::UnitX()}});
  EXPECT_EQ(offsets.lost, 1U);
  EXPECT_TRUE(std::isnan(offsets.mean_m));
}

// Of two crossings the nearer one counts: at -0.5 and +2 voxels.
TEST(SurfaceOffsets, TheNearestCrossingCounts) {
  const auto field = fieldOf(24, [&](const Vec3& p_W) {
    const double x = p_W.x() / kVoxel_m;
    return (x + 0.5) * (x - 2);
  });
  const SurfaceOffsets offsets =
      surfaceOffsets(field, 0, std::vector<ExactSurfacePoint>{{Vec3::Zero(), Vec3::UnitX()}});
  EXPECT_NEAR(offsets.mean_m / kVoxel_m, -0.5, 0.15);  // the parabola, linear between voxels half a voxel away
}

// Trilinear interpolation of |x| errs by at most 3/8 h^2 of the largest second derivative, 1 / R, and never inward of
// the ball: the interpolated distance is too large.
TEST(SurfaceOffsets, OfABallIsTheSagOfInterpolation) {
  constexpr double kRadius_voxel = 10;
  const auto field = fieldOf(32, [&](const Vec3& p_W) { return kRadius_voxel - p_W.norm() / kVoxel_m; });
  Random random(1);
  std::vector<ExactSurfacePoint> points;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 normal_W = random.direction();
    points.push_back({kRadius_voxel * kVoxel_m * normal_W, normal_W});
  }
  const SurfaceOffsets offsets = surfaceOffsets(field, 0, points);
  EXPECT_EQ(offsets.lost, 0U);
  EXPECT_LT(offsets.mean_m, 0);
  EXPECT_LE(offsets.rms_m / kVoxel_m, 3.0 / 8 / kRadius_voxel * 1.05);
  // On average over a cell the error of each axis is h^2 / 12 f'', and the second derivatives sum to 2 / R.
  EXPECT_NEAR(offsets.mean_m / kVoxel_m, -2 / (12 * kRadius_voxel), 0.1 * 2 / (12 * kRadius_voxel));
}

TEST(ExactSurfacePoints, LieOnTheSurfaceAndAwayFromTheBorder) {
  const auto phantom = makePhantom("phantom:knot?size=48x40x32&spacing=1x1.2x1.5mm");
  const std::vector<ExactSurfacePoint> points = exactSurfacePoints(*phantom, 500, 6, 1);
  ASSERT_EQ(points.size(), 500U);
  for (const ExactSurfacePoint& point : points) {
    EXPECT_LE(std::abs(phantom->signedDistance_m(point.p_W)), 1e-12);
    EXPECT_NEAR(point.normal_W.dot(phantom->normal(point.p_W)), 1, 1e-9);
    const Vec3 p_L = phantom->lattice().toIndex(point.p_W);
    EXPECT_GE(p_L.minCoeff(), 6);
    EXPECT_GE((Vec3(47, 39, 31) - p_L).minCoeff(), 6);
  }
}

}  // namespace surface_offsets_test
}  // namespace palpate
