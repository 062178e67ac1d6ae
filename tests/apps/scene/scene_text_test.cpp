// SPDX-License-Identifier: Apache-2.0
// A scene's text, read by readSceneFile().
#include "apps/scene/scene_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"
#include "apps/scene/scene_file.hpp"
#include "base/error.hpp"
#include "temporary_folder.hpp"

namespace palpate {
namespace scene_text_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneText : public testing::Test {
 protected:
  [[nodiscard]] Scene readBack(const std::string& text) const {
    const fs::path file = folder_.path() / "scene.toml";
    std::ofstream(file) << text;
    Scene scene;
    readSceneFile(file, scene);
    return scene;
  }
  static void expectSame(const Scene& a, const Scene& b) {
    for (const SceneOption& option : sceneOptions())
      EXPECT_EQ(optionText(option.value, a), optionText(option.value, b)) << option.key;
    ASSERT_EQ(a.objects.size(), b.objects.size());
    for (std::size_t i = 0; i < a.objects.size(); ++i) EXPECT_EQ(objectText(a.objects[i]), objectText(b.objects[i]));
  }

  TemporaryFolder folder_;
};

TEST_F(SceneText, OfTheDefaultsIsEmpty) {
  EXPECT_EQ(sceneText(Scene{}, folder_.path()), "");
}

TEST_F(SceneText, HoldsTheKeysThatAreAskedFor) {
  const std::string_view keys[] = {"servo.n", "filter"};
  EXPECT_EQ(sceneText(Scene{}, folder_.path(), keys), "filter = \"\"\n\n[servo]\nn = 5\n");
}

// Every option with another value than its default, of each kind, and numbers that have no short decimals.
TEST_F(SceneText, ReadsBackAsTheSameScene) {
  Scene scene;
  scene.volume = "phantom:knot?size=48&noise=0.05";
  scene.isovalue = -1.0 / 3;
  scene.gpu_memory_bytes = std::uint64_t{512} << 20U;
  scene.filter = "median:1 gaussian:0.8mm";
  scene.gradient_all = true;
  scene.gradient_operator = "gaussian:1";
  scene.samples = "half";
  scene.window_edge = 12;
  scene.plane_renewal_ticks = 8;
  scene.stiffness_N_per_m = 1e3 / 7;
  scene.simulated_clock = true;
  scene.require_real_time = true;
  scene.haptization_density = {{0, 0.5, 0.1}, {1e-5, 2, 0}};
  scene.haptization_gradient = {{1e7, 0.25}};
  scene.stiffness_density = {{-1000, 0}, {1000.5, 1}};
  scene.texture = "procedural";
  scene.path_toward = Vec3(1, -2, 3).normalized();
  scene.path_start_W = Vec3(0.01 / 3, -1e-9, 0);
  scene.press_depth_m = 1e-3 / 3;
  scene.out = "quoted \"out\" \\ and\ttab";
  scene.trace = false;
  scene.objects = {parseObject("sphere:centre=1,2,3:radius=0.3"), parseObject("plane:normal=0,1,0"),
                   parseObject("box:size=1,2,3:rotation=10,20,30")};
  expectSame(readBack(sceneText(scene, folder_.path())), scene);
}

// The volume is found from the scene's own folder, wherever the program was started.
TEST_F(SceneText, PathsAreSeenFromTheFolder) {
  Scene scene;
  scene.volume = "scans/head.nii?nan=0";
  scene.path_file = "/paths/way.csv";
  scene.objects = {parseObject("mesh:file=parts/tool.stl")};
  const fs::path here = fs::current_path();
  const std::string text = sceneText(scene, here / "scenes" / "tuned");
  EXPECT_THAT(text, HasSubstr("volume = \"../../scans/head.nii?nan=0\"\n"));
  EXPECT_THAT(text, HasSubstr("file = \"/paths/way.csv\"\n"));
  EXPECT_THAT(text, HasSubstr("file = \"../../parts/tool.stl\"\n"));
  EXPECT_THAT(sceneText(scene, ""), HasSubstr("volume = \"scans/head.nii?nan=0\"\n"));
}

// TOML takes every character of UTF-8 in a string, control characters escaped, and no other bytes.
TEST_F(SceneText, HoldsEveryNameInUtf8AndRefusesOthers) {
  for (const std::string name : {"a\x7f b", "a\x01\x1f", "\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80"}) {
    Scene scene;
    scene.out = name;
    expectSame(readBack(sceneText(scene, folder_.path())), scene);
  }
  for (const std::string name : {"\xFF", "\xC3", "\xC0\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "a\x80"}) {
    Scene scene;
    scene.out = name;
    try {
      static_cast<void>(sceneText(scene, folder_.path()));
      ADD_FAILURE() << "accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      EXPECT_THAT(error.what(), HasSubstr("not in UTF-8"));
    }
  }
}

// A comment is read over, whatever the words held.
TEST_F(SceneText, CommentsAreReadOver) {
  std::string words = "first\nsecond \xC3\xA4 \xFF\xC3";
  for (char c = 1; c < 0x20; ++c) words += c;
  words += "\x7f";
  const std::string comment = tomlComment(words);
  EXPECT_TRUE(comment.starts_with("# first\n# second \xC3\xA4 ??")) << comment;
  Scene scene;
  scene.plane_renewal_ticks = 9;
  EXPECT_EQ(readBack(comment + sceneText(scene, folder_.path())).plane_renewal_ticks, 9);
}

}  // namespace scene_text_test
}  // namespace palpate
