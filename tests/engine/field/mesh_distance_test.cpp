// SPDX-License-Identifier: Apache-2.0
// Distances of a box, whose faces say what they are.
#include "engine/field/mesh_distance.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/refusal.hpp"

namespace palpate {
namespace mesh_distance_test {

const std::vector<Vec3i> kBox = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

std::vector<Vec3> corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c)
    points.emplace_back((c & 1) != 0 ? high.x() : low.x(), (c & 2) != 0 ? high.y() : low.y(),
                        (c & 4) != 0 ? high.z() : low.z());
  return points;
}

// A band of 1.5 voxels is 3 with a voxel to spare, and the box's sides are 12, 10 and 8 voxels, rounded up. Right
// beside the middle of a face its distance alone counts; floats of up to 20 voxels are rounded by 1e-6 of one,
// distances as well. Elsewhere the sign is looked at.
TEST(MeshDistance, IsThatOfTheNearestFaceOfABox) {
  const Vec3 low(1.3e-3, 2.7e-3, -3.4e-3), sides(11.5e-3, 9.5e-3, 7.5e-3);
  constexpr double kVoxel_m = 1e-3;
  const MeshDistance mesh = meshDistance(corners(low, low + sides), kBox, kVoxel_m, 1.5 * kVoxel_m, 2.2 * kVoxel_m);
  ASSERT_EQ(mesh.size, Vec3i(12 + 7, 10 + 7, 8 + 7));
  EXPECT_EQ(mesh.lattice.spacing_m, Vec3::Constant(kVoxel_m));
  EXPECT_EQ(mesh.lattice.R_WL, Mat3::Identity());
  EXPECT_LE((mesh.lattice.origin_W - (low - Vec3::Constant(3e-3))).norm(), 1e-15);
  ASSERT_EQ(mesh.distance_m.size(), static_cast<std::size_t>(mesh.size.prod()));
  int beside_faces = 0;
  for (int n = 0; n < mesh.size.prod(); ++n) {
    const Vec3i voxel(n % mesh.size.x(), n / mesh.size.x() % mesh.size.y(), n / mesh.size.x() / mesh.size.y());
    const Vec3 p_W = mesh.lattice.toWorld(voxel.cast<double>());
    // How far it lies beyond the nearer of each axis' two faces.
    Vec3 beyond = (p_W - (low + sides / 2)).cwiseAbs() - sides / 2;
    int axis = 0;
    const double farthest = beyond.maxCoeff(&axis);
    const double got = static_cast<double>(mesh.distance_m[static_cast<std::size_t>(n)]);
    if (std::abs(farthest) > 1e-9) {  // some voxels lie in a face
      ASSERT_EQ(got > 0, farthest > 0) << voxel.transpose();
    }
    beyond[axis] = -1;
    if (farthest > 1.5 * kVoxel_m || farthest < -2.2 * kVoxel_m || beyond.maxCoeff() > -3.2 * kVoxel_m) continue;
    ++beside_faces;
    ASSERT_NEAR(got, farthest, 1e-8) << voxel.transpose();
  }
  EXPECT_GT(beside_faces, 100);
}

TEST(MeshDistance, SaysWhatIsNoMesh) {
  const auto refusal = [](const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles, double voxel_m,
                          double band_m, double depth_m) {
    return refusalOf([&] { static_cast<void>(meshDistance(points, triangles, voxel_m, band_m, depth_m)); });
  };
  const std::vector<Vec3> points = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const std::vector<Vec3i> one = {{0, 1, 2}};
  const std::string lengths = "mesh: its voxel size, band or depth is not positive; give lengths above 0";
  EXPECT_EQ(refusal(points, one, 0, 1, 1), lengths);
  EXPECT_EQ(refusal(points, one, 1, 0, 1), lengths);
  EXPECT_EQ(refusal(points, one, 1, 1, INFINITY), lengths);
  EXPECT_EQ(refusal(points, {}, 1, 1, 1), "mesh: it has no triangles; give a closed surface");
  const std::string corner = "mesh: a triangle names a corner that is not among its 3; write it again";
  EXPECT_EQ(refusal(points, {{0, 1, 3}}, 1, 1, 1), corner);
  EXPECT_EQ(refusal(points, {{0, 1, 2}, {0, -1, 2}}, 1, 1, 1), corner);
  EXPECT_EQ(refusal({{0, 0, 0}, {0, NAN, 0}, {0, 4, 0}}, one, 1, 1, 1),
            "mesh: one of its corners is not a number; write it again");
  // 4 m are 1024 voxels, around which lie 2 of the band and 1 to spare on either side, and one more.
  EXPECT_EQ(refusal(points, one, 0x1p-8, 0x1p-7, 1),
            "mesh: at 3.90625 mm it needs 1031 voxels along an axis, and 512 are the most; "
            "give a larger voxel or a smaller mesh");
}

}  // namespace mesh_distance_test
}  // namespace palpate
