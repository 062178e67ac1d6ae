// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/scene_objects.hpp"

#include <cmath>
#include <fstream>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/object_table.hpp"
#include "base/error.hpp"
#include "base/vec.hpp"
#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace scene_objects_test {

// About x first: y goes to z; then about y: z goes to x; then about z: x goes to y.
TEST(SceneObjects, RotationsAreAboutTheWorldsXThenYThenZ) {
  const Mat3 R = rotationOf({90, 90, 90});
  EXPECT_LE((R * Vec3::UnitY() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_LE((rotationOf({90, 0, 0}) * Vec3::UnitY() - Vec3::UnitZ()).norm(), 1e-15);
  EXPECT_LE((rotationOf({90, 90, 0}) * Vec3::UnitY() - Vec3::UnitX()).norm(), 1e-15);
}

TEST(SceneObjects, AreWhereTheSceneSays) {
  TemporaryFolder folder;
  const std::string file = (folder.path() / "sheet.obj").string();
  std::ofstream(file) << "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
  const SceneObjects scene = makeSceneObjects(
      {parseObject("sphere:centre=1,2,3:radius=2"), parseObject("box:centre=0,0,0:size=2,4,6:rotation=0,0,90"),
       parseObject("plane:point=0,0,5:normal=0,0,-1"),
       parseObject("mesh:position=0,0,7:rotation=90,0,0:scale=2:unit=cm:file=" + file)});
  ASSERT_EQ(scene.objects.size(), 4U);
  const auto nearest = [&](std::size_t i, const Vec3& x_mm) -> Vec3 {
    return 1e3 * scene.objects[i]->nearest(1e-3 * x_mm).p_W;
  };
  EXPECT_LE((nearest(0, {1, 2, 9}) - Vec3(1, 2, 5)).norm(), 1e-12);
  EXPECT_LE((nearest(1, {9, 0, 0}) - Vec3(2, 0, 0)).norm(), 1e-12) << "its 4 mm lie along x";
  EXPECT_LE((nearest(2, {1, 1, 9}) - Vec3(1, 1, 5)).norm(), 1e-12);
  // The triangle's tip, 1 unit = 20 mm along y, is turned to z. Vertices were floats.
  EXPECT_LE((nearest(3, {0, 0, 99}) - Vec3(0, 0, 27)).norm(), 1e-4);
  EXPECT_THAT(scene.notes, testing::ElementsAre(file + ": the mesh is not closed, so it is touched from both sides"));
  EXPECT_EQ(scene.outlines.size(), 3U + 12U + 4U + 3U);
}

// Ends of a line; its points are evenly spaced between them.
std::pair<Vec3, Vec3> endsOf(const std::vector<Vec3>& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(line.size() - 1);
    EXPECT_LT((line[i] - line.front() - share * (line.back() - line.front())).norm(), 1e-12);
  }
  return {line.front(), line.back()};
}

// Three circles about the axes through the centre.
TEST(SceneObjects, ABallIsDrawnAsThreeCircles) {
  const auto outlines = makeSceneObjects({parseObject("sphere:centre=1,2,3:radius=4")}).outlines;
  ASSERT_EQ(outlines.size(), 3U);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<Vec3>& circle = outlines[static_cast<std::size_t>(axis)];
    ASSERT_EQ(circle.size(), 97U);
    const Vec3 centre(1e-3, 2e-3, 3e-3);
    for (std::size_t i = 0; i < circle.size(); ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / 96;
      const Vec3 arm = std::cos(angle) * Vec3::Unit((axis + 1) % 3) + std::sin(angle) * Vec3::Unit((axis + 2) % 3);
      EXPECT_LT((circle[i] - centre - 4e-3 * arm).norm(), 1e-12) << axis;
    }
  }
}

// Its twelve edges: from each corner one along each axis. Turned by 90 degrees about z, x is y.
TEST(SceneObjects, ABoxIsDrawnByItsEdges) {
  for (const bool turned : {false, true}) {
    const auto outlines =
        makeSceneObjects({parseObject(std::string("box:centre=1,2,3:size=2,4,6") + (turned ? ":rotation=0,0,90" : ""))})
            .outlines;
    ASSERT_EQ(outlines.size(), 12U);
    const Vec3 half = turned ? Vec3(2e-3, 1e-3, 3e-3) : Vec3(1e-3, 2e-3, 3e-3);
    std::set<std::vector<long>> edges;  // corners in tenths of a millimetre, the lower one first
    for (const auto& line : outlines) {
      const auto [a, b] = endsOf(line);
      for (const Vec3& corner : {a, b}) {
        EXPECT_LT(((corner - Vec3(1e-3, 2e-3, 3e-3)).cwiseAbs() - half).norm(), 1e-12);
      }
      std::vector<long> edge;
      const Vec3 low = a.cwiseMin(b), high = a.cwiseMax(b);
      for (const Vec3& corner : {low, high}) {
        for (int i = 0; i < 3; ++i) edge.push_back(std::lround(1e4 * corner[i]));
      }
      EXPECT_EQ(((high - low).array() > 1e-6).count(), 1);
      edges.insert(edge);
    }
    EXPECT_EQ(edges.size(), 12U);
  }
}

// A square of 40 mm around its point.
TEST(SceneObjects, APlaneIsDrawnAsASquare) {
  const auto outlines = makeSceneObjects({parseObject("plane:point=1,2,3:normal=0,3,4")}).outlines;
  ASSERT_EQ(outlines.size(), 4U);
  const Vec3 point(1e-3, 2e-3, 3e-3), normal(0, 0.6, 0.8);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto [a, b] = endsOf(outlines[i]);
    EXPECT_LT((b - outlines[(i + 1) % 4].front()).norm(), 1e-12);
    EXPECT_NEAR((b - a).norm(), 40e-3, 1e-12);
    EXPECT_NEAR(((a + b) / 2 - point).norm(), 20e-3, 1e-12);
    EXPECT_NEAR((a - point).dot(normal), 0, 1e-12);
    EXPECT_NEAR((b - a).dot((a + b) / 2 - point), 0, 1e-12);
  }
}

// Two triangles of which the second is turned about the edge that they share: that is drawn beyond 30 degrees.
TEST(SceneObjects, AMeshIsDrawnWhereItEndsOrTurns) {
  TemporaryFolder folder;
  const std::string file = (folder.path() / "fold.obj").string();
  for (const double degrees : {25.0, 35.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    std::ofstream(file) << fmt::format("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 {} {}\nf 1 2 3\nf 2 1 4\n", -std::cos(turn),
                                       -std::sin(turn));
    EXPECT_EQ(makeSceneObjects({parseObject("mesh:file=" + file)}).outlines.size(), degrees < 30 ? 4U : 5U) << degrees;
  }
}

TEST(SceneObjects, MeshesMayBeInAnyUnit) {
  TemporaryFolder folder;
  const std::string file = (folder.path() / "sheet.obj").string();
  std::ofstream(file) << "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
  for (const auto& [unit, metres] : {std::pair("m", 1.0), {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}}) {
    const auto objects = makeSceneObjects({parseObject(std::string("mesh:unit=") + unit + ":file=" + file)}).objects;
    EXPECT_LT((objects[0]->nearest(Vec3(0, 9, 0)).p_W - Vec3(0, metres, 0)).norm(), 1e-4 * metres) << unit;
  }
}

TEST(SceneObjects, ARefusalNamesTheObject) {
  ObjectSpec bad = parseObject("sphere:radius=2");
  bad.radius_m = -1;
  try {
    (void)makeSceneObjects({parseObject("sphere:radius=2"), bad});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("object 2 (sphere): "));
  }
}

TEST(SceneObjects, AToolThatStartsInsideOneIsToldSo) {
  ObjectSpec ball;
  ball.kind = ObjectKind::kSphere;
  ball.position_W = Vec3(0, 0, 30e-3);
  ball.radius_m = 5e-3;
  const SceneObjects objects = makeSceneObjects({ball});
  ASSERT_EQ(notesOnStart(objects, Vec3(0, 0, 32e-3)).size(), 1U);
  EXPECT_THAT(notesOnStart(objects, Vec3(0, 0, 32e-3)).front(),
              testing::StartsWith("object 1 (sphere): the tool starts inside"));
  EXPECT_TRUE(notesOnStart(objects, Vec3(0, 0, 36e-3)).empty());
}

// In --object all behind "file=" is its name.
TEST(SceneObjects, KeysBehindTheFileAreTold) {
  const auto refused = [](const std::string& text) {
    return refusalOf([&] { static_cast<void>(makeSceneObjects({parseObject(text)})); }, Error::Code::kNotFound);
  };
  EXPECT_EQ(refused("mesh:file=none.stl:position=0,0,5"),
            "none.stl:position=0,0,5: "
            "there is no such file; all behind 'file=' is the file's name: give the other keys before 'file='");
  EXPECT_THAT(refused("mesh:file=none.stl:unit=cm"), testing::HasSubstr("before 'file='"));
  EXPECT_THAT(refused("mesh:file=none:1.stl"), testing::HasSubstr("check the mesh's path"));
}

}  // namespace scene_objects_test
}  // namespace palpate
