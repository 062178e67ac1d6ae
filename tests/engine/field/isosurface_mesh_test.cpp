// SPDX-License-Identifier: Apache-2.0
#include "engine/field/isosurface_mesh.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/files/volume_file.hpp"
#include "engine/phantoms/phantom.hpp"
#include "tests/engine/files/files.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace isosurface_mesh_test {

// How often an edge is gone along in one direction more than in the other; 0 for every edge of a closed mesh.
int unbalancedEdges(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i], b = t[(i + 1) % 3];
      edges[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  int unbalanced = 0;
  for (const auto& [edge, sum] : edges) unbalanced += sum != 0 ? 1 : 0;
  return unbalanced;
}

double volumeOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    sum += mesh.vertices_W[t[0]].dot(mesh.vertices_W[t[1]].cross(mesh.vertices_W[t[2]])) / 6;
  }
  return sum;
}

// Edges that do not belong to exactly two triangles.
int edgesNotShared(const TriangleMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[std::minmax(t[i], t[(i + 1) % 3])];
  }
  return static_cast<int>(std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 2; }));
}

// Where noise, tiles and thin walls make every kind of cell: still closed.
TEST(IsosurfaceMesh, IsClosedForEveryPhantom) {
  for (const char* name :
       {"phantom:sphere?size=24", "phantom:knot?size=40", "phantom:spheres?size=33", "phantom:shell?size=41",
        "phantom:gyroid?size=40", "phantom:box?size=20", "phantom:head?size=48&noise=0.1", "phantom:random?size=17"}) {
    const Volume volume = loadVolume(name);
    const double isovalue = volume.facts().declared_isovalue.value_or(0.5 * (volume.minimum() + volume.maximum()));
    const TriangleMesh mesh = isosurfaceMesh(volume, isovalue);
    EXPECT_GT(mesh.triangles.size(), 100U) << name;
    EXPECT_EQ(unbalancedEdges(mesh), 0) << name;
    EXPECT_EQ(edgesNotShared(mesh), 0) << name;
    EXPECT_GT(volumeOf(mesh), 0) << name << ": normals point inwards";
  }
}

// Beside what marks no data, and between the largest floats, where differences of densities overflow.
TEST(IsosurfaceMesh, IsClosedWhereDensitiesAreExtreme) {
  constexpr float kLargest = std::numeric_limits<float>::max();
  const Volume ball = loadVolume("phantom:sphere?size=24");
  for (const bool both : {false, true}) {
    std::vector<float> values = ball.toDense();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (both)
        values[i] = std::copysign(kLargest, values[i]);
      else if (i < 24 * 24 * 6)
        values[i] = -kLargest;
    }
    const Volume volume = Volume::fromDense(ball.size(), ball.lattice(), values, ball.facts());
    for (const double isovalue : {0.0, -1e38, static_cast<double>(std::nextafter(-kLargest, 0.0F))}) {
      const TriangleMesh mesh = isosurfaceMesh(volume, isovalue);
      EXPECT_GT(mesh.triangles.size(), 100U) << isovalue;
      EXPECT_EQ(unbalancedEdges(mesh), 0) << isovalue;
      for (const Vec3& vertex_W : mesh.vertices_W) ASSERT_TRUE(vertex_W.allFinite());
    }
  }
}

// A trilinear field is off its function by at most h^2 / 8 times the sum of the second derivatives along the axes.
// Those of the distance to a ball's surface sum to 2 / R there. So the surface is off by h^2 / 4R, and 1/R is 1/(R - h)
// at the cells' corners nearest to the middle.
TEST(IsosurfaceMesh, VerticesLieOnTheBall) {
  const std::unique_ptr<Phantom> phantom = makePhantom("phantom:sphere?size=64");
  const Volume volume = loadVolume("phantom:sphere?size=64");
  const TriangleMesh mesh = isosurfaceMesh(volume, *volume.facts().declared_isovalue);
  const double h_m = volume.lattice().smallestSpacing();
  double radius_m = 0;  // of the ball: from the centre of its vertices
  Vec3 centre_W = Vec3::Zero();
  for (const Vec3& v : mesh.vertices_W) centre_W += v / static_cast<double>(mesh.vertices_W.size());
  for (const Vec3& v : mesh.vertices_W) radius_m = std::max(radius_m, (v - centre_W).norm());
  const double bound_m = h_m * h_m / (4 * (radius_m - h_m)) + std::sqrt(3.0) * h_m / 256;  // vertices keep 1/256
  for (const Vec3& v : mesh.vertices_W) ASSERT_LE(std::abs(phantom->signedDistance_m(v)), bound_m) << v.transpose();
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_W[t[0]], b = mesh.vertices_W[t[1]], c = mesh.vertices_W[t[2]];
    ASSERT_GT((b - a).cross(c - a).dot((a + b + c) / 3 - centre_W), 0) << "a normal points inwards";
  }
}

// All object: the mesh is the box of voxel centres, whatever the voxels' shape and the axes' handedness.
TEST(IsosurfaceMesh, AFullVolumeIsItsBoxAndTurnedAxesStayOutward) {
  VolumeFacts facts;
  facts.source = "test";
  for (const double sign : {1.0, -1.0}) {
    Lattice lattice;
    lattice.origin_W = {1e-3, 2e-3, 3e-3};
    lattice.spacing_m = {1e-3, 0.5e-3, 2e-3};
    lattice.R_WL.col(2) *= sign;
    const Vec3i size(9, 16, 5);
    const Volume volume =
        Volume::fromDense(size, lattice, std::vector<float>(static_cast<std::size_t>(size.prod()), 7), facts);
    const TriangleMesh mesh = isosurfaceMesh(volume, 1);
    ASSERT_EQ(unbalancedEdges(mesh), 0);
    Vec3 low_I = Vec3::Constant(1e9), high_I = -low_I;
    for (const Vec3& v : mesh.vertices_W) {
      low_I = low_I.cwiseMin(lattice.toIndex(v));
      high_I = high_I.cwiseMax(lattice.toIndex(v));
    }
    EXPECT_LE(low_I.norm(), 1e-12);
    EXPECT_LE((high_I - Vec3(8, 15, 4)).norm(), 1e-12);
    const double whole_m3 = 8e-3 * 7.5e-3 * 8e-3;
    EXPECT_NEAR(volumeOf(mesh), whole_m3, 1e-12 * whole_m3) << sign;
  }
}

// Every point of the mesh is within d of the ball's surface, so its volume is within 4 pi R^2 d (1 + d/R + ..) of the
// ball's. d is a vertex' error, bounded as above, and a triangle's sagitta. The vertices of a triangle on a ball lie on
// a circle of radius r. If it holds its own circle's middle, r is l / sqrt(3) at most, l being the longest side, and
// the middle lies r^2 / 2R = l^2 / 6R deep. If not, the deepest point is the middle of that side, l^2 / 8R deep. A
// triangle is within a cell: l is sqrt(3) h at most. Joined ones have sides of 8 h at most.
TEST(IsosurfaceMesh, VolumeOfTheBallAndEdgesSharedByTwo) {
  const std::unique_ptr<Phantom> phantom = makePhantom("phantom:sphere?size=64");
  const Volume volume = loadVolume("phantom:sphere?size=64");
  const double h_m = volume.lattice().smallestSpacing();
  std::size_t before = std::numeric_limits<std::size_t>::max();
  for (const double adaptivity : {0.0, 0.01, 0.2}) {
    const TriangleMesh mesh = isosurfaceMesh(volume, *volume.facts().declared_isovalue, adaptivity);
    EXPECT_EQ(edgesNotShared(mesh), 0) << adaptivity;
    EXPECT_EQ(unbalancedEdges(mesh), 0) << adaptivity;
    EXPECT_GT(volumeOf(mesh), 0) << adaptivity;
    EXPECT_LT(mesh.triangles.size(), before) << adaptivity;
    before = mesh.triangles.size();
    if (adaptivity > 0.01) continue;
    const Vec3 centre_W = phantom->lattice().toWorld((volume.size().cast<double>().array() - 1).matrix() / 2);
    const double radius_m = -phantom->signedDistance_m(centre_W);
    const double side_m = (adaptivity > 0 ? 8 : std::sqrt(3.0)) * h_m;
    const double vertex_m = h_m * h_m / (4 * (radius_m - h_m)) + std::sqrt(3.0) * h_m / 256;
    const double d_m = side_m * side_m / (6 * radius_m) + vertex_m;
    constexpr double kPi = 3.14159265358979;
    EXPECT_NEAR(volumeOf(mesh), 4.0 / 3 * kPi * radius_m * radius_m * radius_m,
                4 * kPi * radius_m * radius_m * d_m * (1 + 2 * d_m / radius_m));
  }
}

// Asked as soon as the cells are known.
TEST(IsosurfaceMesh, IsRefusedWithoutTheMemory) {
  const Volume volume = loadVolume("phantom:sphere?size=32");
  const std::size_t least = 100'000;
  const std::string refusal =
      refusalOf([&] { static_cast<void>(isosurfaceMesh(volume, 0, 0, least)); }, Error::Code::kOutOfMemory);
  EXPECT_THAT(refusal, testing::HasSubstr("phantom:sphere?size=32: its isosurface at 0 passes through "));
  EXPECT_THAT(refusal, testing::HasSubstr("smooth, crop or resample the volume"));
  const TriangleMesh mesh = isosurfaceMesh(volume, 0, 0, 100 * least);
  EXPECT_LT(static_cast<double>(mesh.triangles.size() * sizeof mesh.triangles[0] +
                                mesh.vertices_W.size() * sizeof mesh.vertices_W[0]),
            kMeshBytesPerCell * static_cast<double>(mesh.vertices_W.size()));
}

// As without adaptivity, for every kind of cell.
TEST(IsosurfaceMesh, IsClosedForEveryPhantomWhenAdaptive) {
  for (const char* name : {"phantom:knot?size=40", "phantom:spheres?size=33", "phantom:shell?size=41",
                           "phantom:gyroid?size=40", "phantom:box?size=20", "phantom:head?size=48&noise=0.1"}) {
    const Volume volume = loadVolume(name);
    const double isovalue = volume.facts().declared_isovalue.value_or(0.5 * (volume.minimum() + volume.maximum()));
    for (const double adaptivity : {0.05, 1.0}) {
      const TriangleMesh mesh = isosurfaceMesh(volume, isovalue, adaptivity);
      EXPECT_GT(mesh.triangles.size(), 10U) << name;
      EXPECT_EQ(unbalancedEdges(mesh), 0) << name << ' ' << adaptivity;
      EXPECT_GT(volumeOf(mesh), 0) << name << ": normals point inwards";
    }
  }
}

// A plane that cuts off a corner of the box, or leaves it alone: the field is linear, so the mesh is that corner
// exactly. A plane at a distance of s along each axis cuts off s^3 / 6, and meets the border's squares with one, two
// and three voxels inside.
TEST(IsosurfaceMesh, OfALinearFieldIsExact) {
  const Vec3i size(9, 10, 11);
  for (int which = 0; which < 8; ++which) {
    for (const double s : {5.3, 2.5, 7.75}) {
      for (const float sign : {1.0F, -1.0F}) {
        std::vector<float> values;
        for (int n = 0; n < size.prod(); ++n) {
          Vec3i voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
          for (int axis = 0; axis < 3; ++axis)
            voxel[axis] = (which >> axis & 1) != 0 ? size[axis] - 1 - voxel[axis] : voxel[axis];
          values.push_back(sign * static_cast<float>(s - voxel.sum()));
        }
        const Volume volume = Volume::fromDense(size, plainLattice(), values, {});
        const double corner = s * s * s / 6;
        const double expected = sign > 0 ? corner : 8.0 * 9 * 10 - corner;
        const double unit_m3 = volume.lattice().spacing_m.prod();
        for (const double adaptivity : {0.0, 1e-12}) {
          const TriangleMesh mesh = isosurfaceMesh(volume, 0, adaptivity);
          // Floats hold s to 2^-23 of it.
          EXPECT_NEAR(volumeOf(mesh) / unit_m3, expected, 1e-4)
              << which << ' ' << s << ' ' << sign << ' ' << adaptivity;
          EXPECT_EQ(edgesNotShared(mesh), 0);
        }
      }
    }
  }
}

TEST(IsosurfaceMesh, AnIsovalueThatIsNotReachedGivesNoTriangles) {
  const Volume volume = loadVolume("phantom:sphere?size=16");
  EXPECT_TRUE(isosurfaceMesh(volume, 1e6).triangles.empty());
}

// There is no cell in it that a surface could cross.
TEST(IsosurfaceMesh, OfASliceIsEmpty) {
  for (const Vec3i& size : {Vec3i(1, 9, 10), Vec3i(9, 1, 10), Vec3i(9, 10, 1)}) {
    std::vector<float> values(90, 1.0F);
    values[44] = -1;
    EXPECT_TRUE(isosurfaceMesh(Volume::fromDense(size, plainLattice(), values, {}), 0).triangles.empty());
  }
}

int componentsOf(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> parent(mesh.vertices_W.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v];
    return v;
  };
  for (const auto& t : mesh.triangles) {
    parent[root(t[0])] = root(t[1]);
    parent[root(t[1])] = root(t[2]);
  }
  int components = 0;
  for (std::uint32_t v = 0; v < parent.size(); ++v) components += parent[v] == v ? 1 : 0;
  return components;
}

// Two columns that touch along an edge only, a = (0, 0) and c = (1, 1) of each slice, of density d, others e. The
// bilinear field's saddle is (d d - e e) / (2 d - 2 e): of 3 and -1 it is 1, above 0, and joins them; of 1 and -3 it is
// -1 and parts them; of 1 and -1 it is 0, which is background. Likewise of b = (1, 0) and d = (0, 1), and along every
// axis.
TEST(IsosurfaceMesh, JoinsCornersWhereTheSaddleIsInside) {
  for (const auto& [inside, outside, components] :
       {std::tuple(3.0F, -1.0F, 1), std::tuple(1.0F, -3.0F, 2), std::tuple(1.0F, -1.0F, 2)}) {
    for (int along = 0; along < 3; ++along) {
      for (const bool other_corners : {false, true}) {
        std::vector<float> values;
        for (int corner = 0; corner < 8; ++corner) {
          const bool same = (corner >> (along + 1) % 3 & 1) == (corner >> (along + 2) % 3 & 1);
          values.push_back(same != other_corners ? inside : outside);
        }
        const Volume volume = Volume::fromDense({2, 2, 2}, plainLattice(), values, {});
        EXPECT_EQ(componentsOf(isosurfaceMesh(volume, 0)), components) << inside << ' ' << along << other_corners;
      }
    }
  }
}

// Flat faces: nothing is lost by joining their triangles, so the volume stays; no edge grows beyond eight voxels, which
// some reach; and all vertices that stay are where they were.
TEST(IsosurfaceMesh, OfABoxHasLargeTrianglesAndItsVolume) {
  const Vec3i size(33, 21, 17);
  const Lattice lattice{Vec3::Zero(), Mat3::Identity(), Vec3::Constant(1e-3)};
  const Volume volume =
      Volume::fromDense(size, lattice, std::vector<float>(static_cast<std::size_t>(size.prod()), 7), {});
  const TriangleMesh full = isosurfaceMesh(volume, 1), joined = isosurfaceMesh(volume, 1, 0.01);
  EXPECT_LT(joined.triangles.size(), full.triangles.size() / 3);
  EXPECT_EQ(edgesNotShared(joined), 0);
  EXPECT_NEAR(volumeOf(joined), 32e-3 * 20e-3 * 16e-3, 1e-5 * 32e-3 * 20e-3 * 16e-3);
  double longest_m = 0;
  for (const auto& t : joined.triangles) {
    for (std::size_t i = 0; i < 3; ++i)
      longest_m = std::max(longest_m, (joined.vertices_W[t[i]] - joined.vertices_W[t[(i + 1) % 3]]).norm());
  }
  EXPECT_LE(longest_m, 8e-3 * (1 + 1e-12));
  EXPECT_GT(longest_m, 7e-3);
  std::set<std::array<double, 3>> places;
  for (const Vec3& v : full.vertices_W) places.insert({v.x(), v.y(), v.z()});
  for (const Vec3& v : joined.vertices_W) EXPECT_TRUE(places.contains({v.x(), v.y(), v.z()}));
}

}  // namespace isosurface_mesh_test
}  // namespace palpate
