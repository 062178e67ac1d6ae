// SPDX-License-Identifier: Apache-2.0
// Meshes against the shapes that they stand for.
#include "servo/meshes/mesh_object.hpp"

#include <random>

#include <gtest/gtest.h>

#include "servo/objects/shapes.hpp"
#include "support/test_meshes.hpp"

namespace palpate {
namespace mesh_object_test {

// Embree chooses the triangle in float: near an edge, within some 2e-7 of the size, it may choose the other one.
constexpr double kFloat_m = 2e-7 * 0.01;

struct Line {
  Vec3 from_W, to_W;
};

std::vector<Line> randomLines(int count, double reach_m) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-reach_m, reach_m);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  std::vector<Line> lines;
  for (int i = 0; i < count; ++i) lines.push_back({vector(), vector()});
  return lines;
}

// The same entries, lines that begin inside included. Where the mesh's float edge and the box's differ by a hair, one
// may enter and the other not; these lines pass an edge within kFloat_m, and there are none of them here.
TEST(MeshObject, ABoxOfTrianglesIsABox) {
  const Vec3 size_m(4e-3, 6e-3, 8e-3);
  const MeshObject mesh(boxMesh(Vec3::Zero(), size_m));
  const BoxObject box(Vec3::Zero(), size_m);
  EXPECT_TRUE(mesh.solid());
  int entered = 0;
  for (const Line& line : randomLines(20000, 8e-3)) {
    const auto of_mesh = mesh.firstEntry(line.from_W, line.to_W);
    const auto of_box = box.firstEntry(line.from_W, line.to_W);
    ASSERT_EQ(of_mesh.has_value(), of_box.has_value()) << line.from_W.transpose() << " to " << line.to_W.transpose();
    const ObjectPoint near_mesh = mesh.nearest(line.from_W);
    const ObjectPoint near_box = box.nearest(line.from_W);
    ASSERT_LE((near_mesh.p_W - near_box.p_W).norm(), 1e-15);
    // On an edge, whose triangles are equally near, the one that faces the place most.
    ASSERT_GE(near_mesh.normal_W.dot(near_box.normal_W), near_box.normal_W.cwiseAbs().maxCoeff() - 1e-6);
    if (!of_mesh) continue;
    ++entered;
    ASSERT_LE((of_mesh->at.p_W - of_box->at.p_W).norm(), kFloat_m);
    ASSERT_LE((of_mesh->at.normal_W - of_box->at.normal_W).norm(), 1e-12);
    ASSERT_NEAR(of_mesh->share, of_box->share, kFloat_m / (line.to_W - line.from_W).norm());
  }
  EXPECT_GT(entered, 1000);
}

// A triangle with edges of at most h, its corners on a sphere of radius R, is at most h^2 / (6 R) inside it (its
// circumradius is at most h / sqrt(3), the sagitta rho^2 / 2R, plus 1 % for higher orders).
TEST(MeshObject, ASphereOfTrianglesIsASphereWithinTheSagitta) {
  const double radius_m = 5e-3;
  const TriangleMesh triangles = sphereMesh(Vec3::Zero(), radius_m, 3);
  const double h_m = longestEdge(triangles);
  const double sagitta_m = 1.01 * h_m * h_m / (6 * radius_m);
  const MeshObject mesh(triangles);
  const SphereObject sphere(Vec3::Zero(), radius_m);
  for (const Line& line : randomLines(5000, 8e-3)) {
    ASSERT_LE((mesh.nearest(line.from_W).p_W - sphere.nearest(line.from_W).p_W).dot(line.from_W.normalized()), 1e-12);
    ASSERT_NEAR(mesh.nearest(line.from_W).p_W.norm(), radius_m, sagitta_m);
    const auto entry = mesh.firstEntry(line.from_W, line.to_W);
    if (!entry) continue;
    ASSERT_NEAR(entry->at.p_W.norm(), radius_m, sagitta_m);
    // A facet leans by at most its circumradius over R.
    ASSERT_GT(entry->at.normal_W.dot(entry->at.p_W.normalized()), std::cos(1.01 * h_m / (std::sqrt(3.0) * radius_m)));
  }
}

TEST(MeshObject, WatertightAlongEdgesAndThroughVertices) {
  const TriangleMesh triangles = sphereMesh(Vec3::Zero(), 5e-3, 3);
  const MeshObject mesh(triangles);
  for (const auto& t : triangles.triangles) {
    for (const double along : {0.0, 0.25, 0.5, 1.0}) {
      const Vec3 on_edge_W =
          triangles.vertices_W[t[0]] + along * (triangles.vertices_W[t[1]] - triangles.vertices_W[t[0]]);
      ASSERT_TRUE(mesh.firstEntry(2 * on_edge_W, Vec3::Zero()));
    }
  }
}

TEST(MeshObject, FromInsideItIsEnteredOnlyAfterItWasLeft) {
  // Two boxes in one mesh; from inside the first, out through its side, into the second.
  TriangleMesh two = boxMesh(Vec3::Zero(), Vec3::Constant(2e-3));
  const TriangleMesh second = boxMesh({4e-3, 0, 0}, Vec3::Constant(2e-3));
  for (const Vec3& vertex : second.vertices_W) two.vertices_W.push_back(vertex);
  for (const auto& t : second.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  const MeshObject mesh(two);
  const auto entry = mesh.firstEntry(Vec3::Zero(), {4e-3, 0, 0});
  ASSERT_TRUE(entry);
  EXPECT_NEAR(entry->at.p_W.x(), 3e-3, kFloat_m);
  EXPECT_FALSE(mesh.firstEntry(Vec3::Zero(), {2e-3, 0, 0}));
}

TEST(MeshObject, ASheetIsEnteredFromBothSides) {
  TriangleMesh sheet;
  sheet.vertices_W = {{0, 0, 0}, {4e-3, 0, 0}, {0, 4e-3, 0}};
  sheet.triangles = {{0, 1, 2}};
  const MeshObject mesh(sheet);
  EXPECT_FALSE(mesh.solid());
  EXPECT_EQ(mesh.notes().size(), 1U);
  const Vec3 above_W(1e-3, 1e-3, 1e-3), below_W(1e-3, 1e-3, -1e-3);
  const auto down = mesh.firstEntry(above_W, below_W);
  const auto up = mesh.firstEntry(below_W, above_W);
  ASSERT_TRUE(down && up);
  EXPECT_EQ(down->at.normal_W, Vec3(Vec3::UnitZ()));
  EXPECT_EQ(up->at.normal_W, Vec3(-Vec3::UnitZ()));
  EXPECT_EQ(mesh.nearest(below_W).normal_W, Vec3(-Vec3::UnitZ()));
}

// A device that is out of its mind may report any place: no ray that Embree refuses comes of it.
TEST(MeshObject, WaysOfAnyLengthAreSearched) {
  const MeshObject mesh(boxMesh(Vec3::Zero(), Vec3::Constant(20e-3)));
  for (const double far_m : {1.0, 1e3, 1e9, 1e30, 1e150, 1e300}) {
    const auto entry = mesh.firstEntry(Vec3(1e-3, 2e-3, far_m), Vec3(1e-3, 2e-3, -far_m));
    if (far_m <= 1e9) {
      ASSERT_TRUE(entry) << far_m;  // beyond, a double does not tell the box's top from its bottom
    }
    if (entry) {
      EXPECT_TRUE(entry->at.p_W.allFinite()) << far_m;
      EXPECT_GE(entry->share, 0) << far_m;
      EXPECT_LE(entry->share, 1) << far_m;
    }
    EXPECT_FALSE(mesh.firstEntry(Vec3(1, 2e-3, far_m), Vec3(1, 2e-3, -far_m))) << far_m;
  }
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(mesh.firstEntry(Vec3(0, 0, 1), Vec3(0, 0, -inf)));
  EXPECT_FALSE(mesh.firstEntry(Vec3(0, 0, std::nan("")), Vec3(0, 0, -1)));
}

}  // namespace mesh_object_test
}  // namespace palpate
