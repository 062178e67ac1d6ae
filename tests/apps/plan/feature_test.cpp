// SPDX-License-Identifier: Apache-2.0
#include "apps/plan/feature.hpp"

#include <set>

#include <gmock/gmock.h>

#include "apps/rivals/scratch_folder.hpp"
#include "apps/scene/scene_text.hpp"
#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace feature_test {

Scene bareTouch() {
  Scene scene;
  scene.volume = "phantom:sphere";
  return bareScene(scene);
}

TEST(Feature, EachIsThereOnceItWasAddedAndGoneOnceItWasRemoved) {
  const ScratchFolder folder;
  for (const Feature& feature : features()) {
    Scene scene = bareTouch();
    const std::string bare = sceneText(scene, ".");
    EXPECT_FALSE(feature.is_in(scene)) << feature.name;
    feature.add(scene, folder.path());
    EXPECT_TRUE(feature.is_in(scene)) << feature.name;
    EXPECT_NE(sceneText(scene, "."), bare) << feature.name;
    feature.remove(scene);
    EXPECT_FALSE(feature.is_in(scene)) << feature.name;
  }
}

// What is felt without a journal, or without saves, is edited all the same.
TEST(Feature, RemovingAPartOfTheEditsLeavesTheOthers) {
  const ScratchFolder folder;
  Scene scene = bareTouch();
  for (const Feature& feature : features())
    if (feature.adds) feature.add(scene, folder.path());
  for (const char* name : {"a journal", "saves", "friction", "texture", "mesh objects"}) {
    Scene less = scene;
    for (const Feature& feature : features())
      if (feature.name == std::string(name)) feature.remove(less);
    std::set<std::string> missing;
    for (const Feature& feature : features())
      if (feature.adds && !feature.is_in(less)) missing.insert(feature.name);
    EXPECT_THAT(missing, testing::ElementsAre(name));
  }
}

TEST(Feature, ABareSceneHasNoneAndKeepsTheRest) {
  const ScratchFolder folder;
  Scene scene;
  scene.volume = "phantom:knot";
  scene.plane_renewal_ticks = 3;
  scene.isovalue = 0.5;
  for (const Feature& feature : features()) feature.add(scene, folder.path());
  const Scene bare = bareScene(scene);
  for (const Feature& feature : features()) EXPECT_FALSE(feature.is_in(bare)) << feature.name;
  EXPECT_EQ(
      sceneText(bare, "."),
      "volume = \"phantom:knot\"\nisovalue = 0.5\n\n[servo]\nn = 3\n\n[output]\ntrace = \"off\"\npicture = \"off\"\n");
}

TEST(Feature, AMeshThatCannotBeWrittenIsRefused) {
  Scene scene = bareTouch();
  for (const Feature& feature : features()) {
    if (feature.name != std::string("mesh objects")) continue;
    EXPECT_THAT(refusalOf([&] { feature.add(scene, "/no/such/folder"); }, Error::Code::kIo),
                testing::HasSubstr("/no/such/folder"));
  }
}

}  // namespace feature_test
}  // namespace palpate
