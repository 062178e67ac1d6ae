// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/object_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace object_table_test {

using testing::HasSubstr;

std::string refusal(const std::string& text) {
  try {
    (void)parseObject(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), testing::StartsWith("--object '" + text + "'"));
    return error.what();
  }
  return "nothing";
}

TEST(ObjectTable, ReadsEveryKind) {
  const ObjectSpec plane = parseObject("plane:point=1,2,3:normal=0,0,2");
  EXPECT_EQ(plane.kind, ObjectKind::kPlane);
  EXPECT_LE((plane.position_W - Vec3(1e-3, 2e-3, 3e-3)).norm(), 1e-18);
  EXPECT_EQ(plane.normal_W, Vec3(0, 0, 2));
  const ObjectSpec sphere = parseObject("sphere:centre=0,0,30:radius=5");
  EXPECT_EQ(sphere.kind, ObjectKind::kSphere);
  EXPECT_DOUBLE_EQ(sphere.position_W.z(), 30e-3);
  EXPECT_DOUBLE_EQ(sphere.radius_m, 5e-3);
  const ObjectSpec box = parseObject("box:size=20,10,2:centre_mm=1,1,1:rotation=0,90,0");
  EXPECT_LE((box.size_m - Vec3(20e-3, 10e-3, 2e-3)).norm(), 1e-17);
  EXPECT_EQ(box.rotation_deg, Vec3(0, 90, 0));
  const ObjectSpec mesh = parseObject("mesh:unit=in:scale=2:position=1,2,3:file=/a b/c=d:e.stl");
  EXPECT_EQ(mesh.file, "/a b/c=d:e.stl");
  EXPECT_EQ(mesh.unit, "in");
  EXPECT_EQ(mesh.scale, 2);
}

TEST(ObjectTable, TextsComeBack) {
  for (const char* text : {"plane:point=1,2,3:normal=0,0.6,0.8", "sphere:centre=0,0,30:radius=5",
                           "box:centre=1,2,3:size=4,5,6:rotation=7,8,9",
                           "mesh:position=1,2,3:rotation=0,0,45:scale=0.5:unit=cm:file=a:b.ply",
                           "sphere:centre=0.1,0.2,1.2345678901234567:radius=1e+300"}) {
    EXPECT_EQ(objectText(parseObject(text)), text);
  }
}

TEST(ObjectTable, SaysWhatIsWrongWithAnObject) {
  EXPECT_THAT(refusal("cone:radius=2"), HasSubstr("there is no object of kind 'cone'; use plane, sphere, box or mesh"));
  EXPECT_THAT(refusal(""), HasSubstr("there is no object of kind ''"));
  EXPECT_THAT(refusal("sphere:size=1,1,1"), HasSubstr("a sphere has no 'size'; it takes centre, radius"));
  EXPECT_THAT(refusal("sphere:radius"), HasSubstr("'radius' has no value"));
  EXPECT_THAT(refusal("sphere:radius:centre=1,2,3"), HasSubstr("'radius' has no value"));
  EXPECT_THAT(refusal("sphere"), HasSubstr("a sphere needs 'radius'; give a number"));
  EXPECT_THAT(refusal("box:centre=1,2,3"), HasSubstr("a box needs 'size'; give x,y,z"));
  EXPECT_THAT(refusal("plane:point=1,2,3"), HasSubstr("a plane needs 'normal'"));
  EXPECT_THAT(refusal("mesh:unit=mm"), HasSubstr("a mesh needs 'file'"));
  EXPECT_THAT(refusal("mesh:file="), HasSubstr("is not what it takes"));
  EXPECT_THAT(refusal("sphere:radius=5:radius=6"), HasSubstr("'radius' is given twice"));
  EXPECT_THAT(refusal("sphere:radius=five"), HasSubstr("radius 'five' is not what it takes; give a number"));
  EXPECT_THAT(refusal("sphere:radius=nan"), HasSubstr("is not what it takes"));
  EXPECT_THAT(refusal("sphere:radius=-5"), HasSubstr("the radius is not positive"));
  EXPECT_THAT(refusal("sphere:radius=0"), HasSubstr("the radius is not positive"));
  EXPECT_THAT(refusal("sphere:centre=1,2:radius=5"), HasSubstr("give x,y,z"));
  EXPECT_THAT(refusal("box:size=1,0,1"), HasSubstr("an edge is not positive"));
  EXPECT_THAT(refusal("plane:normal=0,0,0"), HasSubstr("the normal is zero"));
  EXPECT_THAT(refusal("mesh:scale=0:file=a.stl"), HasSubstr("the scale is not positive"));
  EXPECT_THAT(refusal("mesh:unit=ell:file=a.stl"), HasSubstr("the unit 'ell' is not known; use mm, cm, m or in"));
}

TEST(ObjectTable, AKindOrAKeyWithATypoIsRecognised) {
  forEachTypo({"plane", "sphere", "box", "mesh"}, [](const std::string& kind, const std::string& typed) {
    EXPECT_THAT(suggestedIn(refusal(typed + ":radius=2")), HasSubstr(kind)) << typed;
  });
  EXPECT_EQ(suggestedIn(refusal("sphere:radus=5")), "radius");
}

// A scene file has other names for them.
TEST(ObjectTable, NamesKeysAsTheyAreInAFile) {
  const auto inFile = [](const std::vector<std::pair<std::string, std::string>>& keys) {
    return refusalOf([&] { static_cast<void>(makeObjectSpec("sphere", keys, "a.toml:1: object")); });
  };
  EXPECT_EQ(inFile({}), "a.toml:1: object: a sphere needs 'radius_mm'; give a number");
  EXPECT_EQ(inFile({{"size_mm", "5"}}), "a.toml:1: object: a sphere has no 'size_mm'; it takes centre_mm, radius_mm");
}

TEST(ObjectTable, TheDocumentHasARowForEachKey) {
  for (const ObjectOption& option : objectOptions()) {
    EXPECT_THAT(objectDocument(), HasSubstr(std::string("\n| `") + option.key + "` | `" + option.word + "` |"));
    EXPECT_TRUE(std::string(option.key).starts_with(option.word));
  }
}

}  // namespace object_table_test
}  // namespace palpate
