// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "temporary_folder.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace scene_file_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SceneFile : public testing::Test {
 protected:
  [[nodiscard]] fs::path write(const std::string& text) const {
    const fs::path file = folder_.path() / "scene.toml";
    std::ofstream(file) << text;
    return file;
  }
  [[nodiscard]] Scene read(const std::string& text) const {
    Scene scene;
    readSceneFile(write(text), scene);
    return scene;
  }
  // The message; the scene must be as it was.
  [[nodiscard]] static std::string refusal(const fs::path& file, Error::Code code = Error::Code::kBadInput) {
    Scene scene;
    scene.volume = "mine";
    scene.duration_s = 77;
    try {
      readSceneFile(file, scene);
      return "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      EXPECT_EQ(scene.volume, "mine");
      EXPECT_EQ(scene.duration_s, 77);
      EXPECT_EQ(scene.press_depth_m, Scene{}.press_depth_m);
      EXPECT_THAT(error.what(), testing::StartsWith(file.string()));
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
      return error.what();
    }
  }
  [[nodiscard]] std::string refusalOf(const std::string& text) const { return refusal(write(text)); }

  TemporaryFolder folder_;
};

// Editors write it in front of UTF-8.
TEST_F(SceneFile, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(read("\xEF\xBB\xBFvolume = 'phantom:box'\nisovalue = 3\n").isovalue, 3);
}

TEST_F(SceneFile, SetsKeysOfEveryKind) {
  const Scene scene = read(R"(
volume = "phantom:knot?size=32"
isovalue = -20.5
gradient = "all"
[servo]
n = 7
stiffness_N_per_m = 1e3
clock = "simulated"
[path]
toward = [0, 0, -2]
start_mm = [1.5, -2, 3]
[haptization]
density = [[-1000, 0, 0], [200, 0.5, 1]]
gradient = [
  [0, 0],
  [50, 1],
]
[output]
trace = false
picture = "on"
)");
  EXPECT_EQ(scene.haptization_density, (NumberTable{{-1000, 0, 0}, {200, 0.5, 1}}));
  EXPECT_EQ(scene.haptization_gradient, (NumberTable{{0, 0}, {50000, 1}}));
  EXPECT_EQ(scene.volume, "phantom:knot?size=32");
  EXPECT_EQ(scene.isovalue, -20.5);
  EXPECT_TRUE(scene.gradient_all);
  EXPECT_EQ(scene.plane_renewal_ticks, 7);
  EXPECT_EQ(scene.stiffness_N_per_m, 1000);
  EXPECT_TRUE(scene.simulated_clock);
  EXPECT_EQ(scene.path_toward, Vec3(0, 0, -1));
  EXPECT_NEAR((*scene.path_start_W - Vec3(1.5e-3, -2e-3, 3e-3)).norm(), 0, 1e-18);
  EXPECT_FALSE(scene.trace);
  EXPECT_TRUE(scene.picture);
}

TEST_F(SceneFile, SetsContactEffects) {
  const Scene scene = read(R"(
[contact]
force_shading = true
recovery_ms = 20
texture = "density"
texture_amplitude_mm = 0.05
friction_static = 0.5
stiffness_density = [[200, 0.3], [700, 1]]
)");
  EXPECT_TRUE(scene.force_shading);
  EXPECT_DOUBLE_EQ(scene.recovery_s, 0.02);
  EXPECT_EQ(scene.texture, "density");
  EXPECT_DOUBLE_EQ(scene.texture_amplitude_m, 0.05e-3);
  EXPECT_EQ(scene.friction_static, 0.5);
  EXPECT_EQ(scene.stiffness_density, (NumberTable{{200, 0.3}, {700, 1}}));
}

TEST_F(SceneFile, ObjectsAreTables) {
  const Scene scene = read(R"(
volume = "phantom:sphere"
[[object]]
kind = "sphere"
centre_mm = [0, 0, 30]
radius_mm = 5
[[object]]
kind = "mesh"
file = "plate.stl"
[[object]]
kind = "mesh"
file = "/far/plate.stl"
)");
  ASSERT_EQ(scene.objects.size(), 3U);
  EXPECT_EQ(scene.objects[0].kind, ObjectKind::kSphere);
  EXPECT_DOUBLE_EQ(scene.objects[0].radius_m, 5e-3);
  EXPECT_EQ(scene.objects[1].file, (folder_.path() / "plate.stl").string()) << "relative to the scene";
  EXPECT_EQ(scene.objects[2].file, "/far/plate.stl");
}

TEST_F(SceneFile, ObjectsThatAreNoneAreRefused) {
  EXPECT_THAT(refusalOf("[object]\nkind = 'sphere'\n"), HasSubstr("begin each with [[object]]"));
  EXPECT_THAT(refusalOf("object = 5\n"), HasSubstr("begin each with [[object]]"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 'sphere'\n"),
              HasSubstr("scene.toml:1: object: a sphere needs 'radius_mm'"));
  EXPECT_THAT(refusalOf("\n[[object]]\nradius_mm = 5\n"),
              HasSubstr("scene.toml:2: object: there is no object of kind ''"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 'sphere'\nradius_mm = '5'\n"), HasSubstr("'radius_mm' is of another kind"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 'box'\nsize_mm = [1, 'a', 2]\n"),
              HasSubstr("'size_mm' is of another kind"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 5\n"), HasSubstr("'kind' is of another kind"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 'mesh'\nfile = 5\n"), HasSubstr("'file' is of another kind"));
  EXPECT_THAT(refusalOf("[[object]]\nkind = 'box'\nsize_mm = true\n"), HasSubstr("'size_mm' is of another kind"));
}

TEST_F(SceneFile, DottedKeysAndInlineTablesAreTables) {
  EXPECT_EQ(read("servo.n = 3\n").plane_renewal_ticks, 3);
  EXPECT_EQ(read("servo = { n = 4 }\n").plane_renewal_ticks, 4);
}

TEST_F(SceneFile, LeavesOtherKeysAsTheyWere) {
  Scene scene;
  scene.press_depth_m = 9e-3;
  readSceneFile(write("[servo]\nn = 3\n"), scene);
  EXPECT_EQ(scene.press_depth_m, 9e-3);
  EXPECT_EQ(scene.plane_renewal_ticks, 3);
}

// A list of texts, or one text with blanks between.
TEST_F(SceneFile, ChainsAreListsOfTexts) {
  EXPECT_EQ(read("filter = ['median:1', 'gaussian:0.8mm']\n").filter, "median:1 gaussian:0.8mm");
  EXPECT_EQ(read("filter = 'median:1 dilate:2'\n").filter, "median:1 dilate:2");
  for (const char* text : {"filter = 5\n", "filter = ['median:1', 5]\n"})
    EXPECT_THAT(refusalOf(text), testing::EndsWith("of another kind than it takes; give [\"word\", ...]"));
}

// As a scene file writes them: an array, where a flag has commas.
TEST_F(SceneFile, ValuesOfAnotherKindAreToldTheForm) {
  EXPECT_THAT(refusalOf("path.toward = 1\n"), testing::EndsWith("another kind than it takes; give [x, y, z]"));
  EXPECT_THAT(refusalOf("haptization.density = 1\n"),
              testing::EndsWith("another kind than it takes; give [[density, force, viscosity], ...]"));
  EXPECT_THAT(refusalOf("servo.n = false\n"),
              testing::EndsWith("another kind than it takes; give a whole number from 1 to 100000"));
}

// What a scene had before starts elsewhere.
TEST_F(SceneFile, OnlyPathsOfTheFileStartAtTheFile) {
  Scene scene;
  scene.volume = "mine.nrrd";
  scene.path_file = "mine.csv";
  scene.objects.push_back({.kind = ObjectKind::kMesh, .file = "mine.stl"});
  readSceneFile(write("[[object]]\nkind = 'mesh'\nfile = 'plate.stl'\n"), scene);
  EXPECT_EQ(scene.volume, "mine.nrrd");
  EXPECT_EQ(scene.path_file, "mine.csv");
  ASSERT_EQ(scene.objects.size(), 2U);
  EXPECT_EQ(scene.objects[0].file, "mine.stl");
  EXPECT_EQ(scene.objects[1].file, (folder_.path() / "plate.stl").string());
}

TEST_F(SceneFile, RelativePathsStartAtTheFile) {
  const Scene scene =
      read("volume = \"scans/../head.nrrd\"\n[path]\nfile = \"way.csv\"\n[output]\nfolder = \"results\"\n");
  EXPECT_EQ(scene.volume, (folder_.path() / "head.nrrd").string());
  EXPECT_EQ(scene.path_file, (folder_.path() / "way.csv").string());
  EXPECT_EQ(scene.out, "results");  // where the user is, not where the scene lies
}

TEST_F(SceneFile, AbsolutePathsAndPhantomsStay) {
  EXPECT_EQ(read("volume = \"/data/head.nrrd\"\n").volume, "/data/head.nrrd");
  EXPECT_EQ(read("volume = \"phantom:box\"\n").volume, "phantom:box");
  EXPECT_EQ(read("").volume, "");
}

TEST_F(SceneFile, UnknownKeysAreRefusedWithTheNearest) {
  EXPECT_THAT(refusalOf("\n\n[servo]\nstifness_N_per_m = 5\n"),
              testing::AllOf(HasSubstr("scene.toml:4: servo.stifness_N_per_m: "),
                             HasSubstr("did you mean servo.stiffness_N_per_m?")));
  EXPECT_THAT(refusalOf("isvalue = 5\n"), HasSubstr("did you mean isovalue?"));
  EXPECT_THAT(refusalOf("n = 5\n"), HasSubstr("there is no such key"));  // of [servo]
  EXPECT_THAT(refusalOf("[[servo]]\nn = 5\n"), HasSubstr("there is no such key"));
  EXPECT_THAT(refusalOf("[servo.n]\nx = 5\n"), HasSubstr("servo.n.x: there is no such key"));
}

TEST_F(SceneFile, AKeyWithATypoIsRecognised) {
  for (const SceneOption& option : sceneOptions()) {
    const std::string key = option.key;
    const std::size_t name = key.rfind('.') + 1;  // 0 where there is no dot
    forEachTypo({key.substr(name)}, [&](const std::string&, const std::string& typed) {
      const std::string given = key.substr(0, name) + typed;
      if (optionOfKey(given) != nullptr) return;
      EXPECT_THAT(suggestedIn(refusalOf(given + " = 1\n")), HasSubstr(key)) << given;
    });
  }
}

TEST_F(SceneFile, ATableWithATypoAndAForgottenOneAreRecognised) {
  EXPECT_EQ(suggestedIn(refusalOf("[sevro]\nn = 5\n")), "servo.n");
  EXPECT_EQ(suggestedIn(refusalOf("n = 5\n")), "servo.n");
  EXPECT_EQ(suggestedIn(refusalOf("servo.depth = 5\n")), "path.depth_mm");
  EXPECT_EQ(suggestedIn(refusalOf("hand.stiffness = 5\n")), "hand.stiffness_N_per_m");
  EXPECT_EQ(suggestedIn(refusalOf("contact.friction = 5\n")),
            "contact.friction_static, contact.friction_dynamic or contact.friction_viscous_Ns_per_m");
}

// A suggestion that nobody can have meant is worse than none.
TEST_F(SceneFile, NothingIsSuggestedWhereNoKeyIsNear) {
  for (const char* key : {"nn", "servo.xyz", "colour", "sauce.n2"}) {
    EXPECT_THAT(refusalOf(std::string(key) + " = 5\n"),
                testing::EndsWith("there is no such key; 'palpate scene' lists all"));
  }
}

TEST_F(SceneFile, ValuesOfAnotherKindAreRefused) {
  for (const char* text : {"volume = 5",
                           "volume = true",
                           "volume = [1, 2]",
                           "volume = 2020-01-01",
                           "gpu = 1.5",
                           "isovalue = \"5\"",
                           "isovalue = true",
                           "isovalue = [5]",
                           "servo.n = \"5\"",
                           "servo.n = false",
                           "servo.clock = 1",
                           "servo.clock = [\"real\"]",
                           "path.toward = \"0,0,1\"",
                           "path.toward = 1",
                           "path.toward = [[0, 0], 1]",
                           "path.toward = [\"0\", \"0\", \"1\"]",
                           "haptization.density = 1",
                           "haptization.density = [1, 2, 3]",
                           "haptization.density = [[1, 2, 3], 4]",
                           "haptization.density = [[1, 2, \"3\"]]",
                           "haptization.density = \"1:2:3\"",
                           "output.trace = 1",
                           "output.folder = 7",
                           "isovalue = 12:00:00"}) {
    const std::string message = refusalOf(std::string(text) + "\n");
    EXPECT_THAT(message, HasSubstr("scene.toml:1: ")) << text;
    EXPECT_THAT(message, HasSubstr("another kind")) << text;
    EXPECT_THAT(message, HasSubstr("; give ")) << text;
  }
}

TEST_F(SceneFile, AWordIsNoNumberAndNoSwitch) {
  EXPECT_THAT(refusalOf("contact.texture = 1\n"), HasSubstr("another kind"));
  EXPECT_THAT(refusalOf("contact.texture = false\n"), HasSubstr("another kind"));
}

TEST_F(SceneFile, ValuesOfTheRightKindThatDoNotFitAreRefused) {
  for (const char* text :
       {"servo.n = 0", "servo.n = 2.5", "isovalue = nan", "isovalue = inf", "servo.clock = \"fast\"",
        "contact.texture = \"velvet\"", "hand.kind = true", "path.toward = [0, 0, 0]", "path.toward = [1, 0]",
        "path.toward = []", "path.start_mm = [1, 2, nan]", "haptization.density = []", "haptization.density = [[]]",
        "haptization.density = [[1, 2]]", "haptization.gradient = [[1, 2], [3, inf]]", "servo.seconds = -1"}) {
    EXPECT_THAT(refusalOf(std::string(text) + "\n"), HasSubstr("is not what it takes; give ")) << text;
  }
}

TEST_F(SceneFile, SyntaxErrorsNameLineAndColumn) {
  EXPECT_THAT(refusalOf("volume = \"x\"\n[servo\nn = 1\n"), HasSubstr("scene.toml:2:"));
  EXPECT_THAT(refusalOf("volume = \"x\nn = 1\n"), HasSubstr("scene.toml:1:"));
  EXPECT_THAT(refusalOf("[servo]\nn = 1\nn = 2\n"), HasSubstr("scene.toml:3:"));  // twice
  EXPECT_THAT(refusalOf(std::string("\xff\xfe\0x", 4)), HasSubstr("scene.toml:1:"));
}

TEST_F(SceneFile, MissingFilesAndFoldersAreRefused) {
  EXPECT_THAT(refusal(folder_.path() / "nowhere.toml", Error::Code::kNotFound), HasSubstr("cannot be opened"));
  EXPECT_THAT(refusal(folder_.path()), HasSubstr("it is a folder"));
}

}  // namespace scene_file_test
}  // namespace palpate
