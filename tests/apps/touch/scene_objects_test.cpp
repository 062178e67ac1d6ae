// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/scene_objects.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/object_table.hpp"
#include "base/error.hpp"
#include "base/rotation.hpp"
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
  EXPECT_EQ(
      refused("mesh:file=none.stl:position=0,0,5"),
      "none.stl:position=0,0,5: there is no such file; all behind 'file=' is the file's name: give the other keys "
      "before 'file='");
  EXPECT_THAT(refused("mesh:file=none.stl:unit=cm"), testing::HasSubstr("before 'file='"));
  EXPECT_THAT(refused("mesh:file=none:1.stl"), testing::HasSubstr("check the mesh's path"));
}

}  // namespace scene_objects_test
}  // namespace palpate
