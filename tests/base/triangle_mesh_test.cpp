// SPDX-License-Identifier: Apache-2.0
#include "base/triangle_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/servo/support/test_meshes.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace triangle_mesh_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const TriangleMesh kBox = boxMesh({1e-3, 2e-3, 3e-3}, {2e-3, 4e-3, 6e-3});

std::string refusal(TriangleMesh mesh) {
  return refusalOf([&] { (void)prepareMesh(std::move(mesh), "plate.stl"); });
}

TEST(MeshPreparation, AGoodMeshStaysAsItIs) {
  const PreparedMesh prepared = prepareMesh(kBox, "box");
  EXPECT_TRUE(prepared.closed);
  EXPECT_THAT(prepared.notes, IsEmpty());
  EXPECT_EQ(prepared.mesh.triangles.size(), 12U);
  EXPECT_NEAR(sixfoldVolume(prepared.mesh), 6 * 48e-9, 1e-20);
  // Normals of a box about (1, 2, 3) mm point away from it.
  for (std::size_t i = 0; i < 12; ++i) {
    const Vec3 corner_W = prepared.mesh.vertices_W[prepared.mesh.triangles[i][0]];
    EXPECT_GT(prepared.normals_W[i].dot(corner_W - Vec3(1e-3, 2e-3, 3e-3)), 0.9e-3);
    EXPECT_NEAR(prepared.normals_W[i].norm(), 1, 1e-15);
  }
}

// As an STL file has it: three vertices of its own for every triangle.
TEST(MeshPreparation, VerticesAtOnePlaceBecomeOne) {
  TriangleMesh soup;
  for (const auto& triangle : kBox.triangles) {
    for (const std::uint32_t corner : triangle) soup.vertices_W.push_back(kBox.vertices_W[corner]);
    const auto n = static_cast<std::uint32_t>(soup.vertices_W.size());
    soup.triangles.push_back({n - 3, n - 2, n - 1});
  }
  const PreparedMesh prepared = prepareMesh(soup, "soup");
  EXPECT_EQ(prepared.mesh.vertices_W.size(), 8U);
  EXPECT_TRUE(prepared.closed);
}

TEST(MeshPreparation, AMeshTurnedInsideOutIsTurnedBack) {
  TriangleMesh inverted = kBox;
  for (auto& triangle : inverted.triangles) std::swap(triangle[0], triangle[1]);
  const PreparedMesh prepared = prepareMesh(inverted, "plate.stl");
  EXPECT_TRUE(prepared.closed);
  EXPECT_GT(sixfoldVolume(prepared.mesh), 0);
  EXPECT_THAT(prepared.notes, ElementsAre("plate.stl: its normals point inwards and were turned"));
}

TEST(MeshPreparation, AnOpenMeshAndAMuddledOneAreSheets) {
  TriangleMesh open = kBox;
  open.triangles.pop_back();
  TriangleMesh muddled = kBox;
  std::swap(muddled.triangles[4][0], muddled.triangles[4][1]);
  for (const TriangleMesh& mesh : {open, muddled}) {
    const PreparedMesh prepared = prepareMesh(mesh, "sheet");
    EXPECT_FALSE(prepared.closed);
    EXPECT_THAT(prepared.notes, ElementsAre("sheet: the mesh is not closed, so it is touched from both sides"));
  }
}

// A box, and beside it two triangles whose rim goes up and down at every corner by turns: each edge of the rim has one
// triangle all the same.
TEST(MeshPreparation, ASheetIsOpenHoweverItsCornersAreNumbered) {
  TriangleMesh mesh = kBox;
  const auto first = static_cast<std::uint32_t>(mesh.vertices_W.size());
  for (const Vec3& corner_W : {Vec3(1, 0, 0), Vec3(2, 1, 0), Vec3(3, -1, 0), Vec3(4, 9, 0)}) {
    mesh.vertices_W.push_back(0.1 * corner_W);  // beyond the box, in the order in which vertices are kept
  }
  mesh.triangles.push_back({first, first + 2, first + 1});
  mesh.triangles.push_back({first, first + 1, first + 3});
  EXPECT_FALSE(prepareMesh(mesh, "box and sheet").closed);
}

// Every edge of a triangle and its own back side is balanced, but there is nothing between them to be inside of.
TEST(MeshPreparation, ASheetWithABackIsASheet) {
  const TriangleMesh sheet{{{0, 0, 0}, {1e-2, 0, 0}, {0, 1e-2, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  const PreparedMesh prepared = prepareMesh(sheet, "sheet");
  EXPECT_FALSE(prepared.closed);
  EXPECT_THAT(prepared.notes, ElementsAre("sheet: the mesh is not closed, so it is touched from both sides"));
}

// Two boxes, one the other's neighbour with a face in common, stay closed although four triangles meet in an edge.
TEST(MeshPreparation, BodiesThatTouchAreClosed) {
  TriangleMesh two = kBox;
  const TriangleMesh second = boxMesh({3e-3, 2e-3, 3e-3}, {2e-3, 4e-3, 6e-3});
  for (const Vec3& vertex : second.vertices_W) two.vertices_W.push_back(vertex);
  for (const auto& t : second.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_TRUE(prepareMesh(two, "two").closed);
}

TEST(MeshPreparation, TrianglesWithoutAPlaneAreLeftOut) {
  TriangleMesh mesh = kBox;
  mesh.triangles.push_back({0, 0, 1});  // a line: goes there and back, so the mesh is still closed
  mesh.vertices_W.push_back(0.5 * (mesh.vertices_W[0] + mesh.vertices_W[1]));
  const PreparedMesh with_line = prepareMesh(mesh, "plate.stl");
  EXPECT_EQ(with_line.mesh.triangles.size(), 12U);
  EXPECT_TRUE(with_line.closed);
  EXPECT_THAT(with_line.notes, ElementsAre("plate.stl: 1 of 13 triangles are degenerate and were left out"));
  mesh.triangles.back() = {0, 1, 8};  // three corners on a line
  EXPECT_EQ(prepareMesh(mesh, "plate.stl").mesh.triangles.size(), 12U);
  // Denormal coordinates: a height of 1e-310 m is no height.
  mesh.vertices_W.back() += Vec3(0, 1e-310, 0);
  EXPECT_EQ(prepareMesh(mesh, "plate.stl").mesh.triangles.size(), 12U);
}

// A needle of 10 mm whose third corner is near one end: its height over its longest edge decides.
TEST(MeshPreparation, ATriangleHasAPlaneIfItIsHighEnough) {
  for (const double height_m : {0.5 * kThinnest_m, 2 * kThinnest_m}) {
    const auto needle = [&] {
      return TriangleMesh{{{0, 0, 0}, {1e-2, 0, 0}, {1e-6, height_m, 0}, {0, 0, 1e-2}}, {{0, 1, 3}, {0, 1, 2}}};
    };
    EXPECT_EQ(prepareMesh(needle(), "needle").mesh.triangles.size(), height_m > kThinnest_m ? 2U : 1U) << height_m;
  }
}

// 2 m along each axis by turns.
TEST(MeshPreparation, AMeshMayBeAsWideAsQueriesCanTell) {
  for (int axis = 0; axis < 3; ++axis) {
    TriangleMesh mesh{{{0, 0, 0}, {1e-2, 2e-2, 3e-2}, {3e-2, 1e-2, 2e-2}}, {{0, 1, 2}}};
    mesh.vertices_W[1][axis] = 2;
    EXPECT_EQ(refusal(mesh), kNoRefusal) << axis;
    mesh.vertices_W[1][axis] = 2.001;
    EXPECT_THAT(refusal(mesh), HasSubstr("the mesh is 2001 mm wide")) << axis;
  }
}

TEST(MeshPreparation, RefusesWhatCannotBeTouched) {
  EXPECT_THAT(refusal({}), HasSubstr("plate.stl: the mesh has no triangles"));
  TriangleMesh mesh = kBox;
  mesh.triangles[3][1] = 8;
  EXPECT_THAT(refusal(mesh), HasSubstr("a triangle names vertex 8 of 8"));
  mesh = kBox;
  mesh.vertices_W[5].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal(mesh), HasSubstr("vertex 5 is not finite"));
  mesh = kBox;
  for (Vec3& vertex : mesh.vertices_W) vertex *= 1000;
  EXPECT_THAT(refusal(mesh), HasSubstr("the mesh is 6000 mm wide, and 2000 mm is the most; check its unit and scale"));
  mesh = kBox;
  mesh.triangles = {{0, 0, 1}};
  EXPECT_THAT(refusal(mesh), HasSubstr("all its triangles are degenerate"));
}

}  // namespace triangle_mesh_test
}  // namespace palpate
