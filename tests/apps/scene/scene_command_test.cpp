// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_command.hpp"

#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"

namespace palpate {
namespace scene_command_test {

TEST(SceneCommand, NamesWhatDiffersFromTheDefaults) {
  Scene scene;
  scene.volume = "scan of a head.nii.gz";
  EXPECT_EQ(sceneCommand("touch", scene), "palpate touch 'scan of a head.nii.gz'");
  scene.isovalue = 226;
  scene.plane_renewal_ticks = 10;
  scene.recovery_s = 0.02;
  scene.service = true;
  EXPECT_EQ(sceneCommand("touch", scene),
            "palpate touch 'scan of a head.nii.gz' --iso 226 --n 10 --service --recovery 20");
  scene.isovalue = -300;
  EXPECT_THAT(sceneCommand("plan", scene), testing::HasSubstr("palpate plan 'scan of a head.nii.gz' --iso=-300 "));
}

// Every option of the table by itself: the flag is the table's, and its value is one that setOption() takes.
TEST(SceneCommand, EveryOptionIsTakenBack) {
  for (const SceneOption& option : sceneOptions()) {
    if (option.key == std::string_view("volume")) continue;
    Scene scene;
    const std::vector<std::string> words = optionWords(option.value);
    for (const std::string& text :
         {std::string("3"), std::string("0.5"), std::string("-7"), std::string("1,2,3"), std::string("1:2"),
          std::string("1:2:3"), std::string("1GiB"), words.empty() ? std::string("a b") : words.back()}) {
      try {
        setOption(option.value, text, option.flag, scene, option.unit);
      } catch (const Error&) {
        continue;
      }
      scene.volume = "v";
      const std::string line = sceneCommand("touch", scene);
      if (isSame(option.value, scene, Scene{})) {
        EXPECT_EQ(line, "palpate touch v") << option.flag;
        continue;
      }
      const std::string flag = std::string("palpate touch v ") + option.flag;
      ASSERT_THAT(line, testing::StartsWith(flag)) << text;
      if (isBare(option.value)) continue;
      std::string value = line.substr(flag.size() + 1);
      if (value.front() == '\'') value = value.substr(1, value.size() - 2);
      Scene back;
      setOption(option.value, value, option.flag, back, option.unit);
      EXPECT_TRUE(isSame(option.value, back, scene)) << line;
    }
  }
}

}  // namespace scene_command_test
}  // namespace palpate
