// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/scene_words.hpp"

#include <gmock/gmock.h>

#include "apps/scene/object_table.hpp"
#include "apps/scene/option_table.hpp"

namespace palpate {
namespace scene_words_test {

using testing::ElementsAre;

TEST(SceneWords, OfTheDefaultsAreNone) { EXPECT_THAT(sceneWords(Scene{}), testing::IsEmpty()); }

TEST(SceneWords, AreTheFlagsOfWhatDiffers) {
  Scene scene;
  scene.volume = "a file.nrrd";
  scene.require_real_time = true;  // a flag without a value
  scene.press_depth_m = 0.0015;
  scene.objects = {parseObject("sphere:centre=0,0,30:radius=5")};
  EXPECT_THAT(sceneWords(scene), ElementsAre("--volume", "a file.nrrd", "--require-real-time", "--depth", "1.5",
                                             "--object", objectText(scene.objects[0])));
}

// Any value that the option takes, in the form that the command line takes. Read back they make the same scene.
TEST(SceneWords, MakeTheSameSceneAgain) {
  const std::vector<std::pair<const char*, const char*>> kValues = {
      {"--volume", "phantom:knot"}, {"--series", "3"},          {"--nan", "-1000"},          {"--gpu", "llvm"},
      {"--gpu-memory", "512MiB"},   {"--filter", "median:1"},   {"--gradient-operator", "sobel"},
      {"--haptization-density", "0:0:0,1:2:3"}, {"--haptization-gradient", "0:0,1:1"}, {"--stiffness-density", "0:1,1:2"},
      {"--path", "way.csv"},        {"--toward", "0,0,1"},      {"--start", "1,2,3.5"},      {"--slide-toward", "1,0,0"},
      {"--edit", "remove:radius=2mm"}, {"--journal", "j"},      {"--save", "s.vdb"},         {"--out", "elsewhere"}};
  const auto valueOf = [&](const SceneOption& option) -> std::string {
    for (const auto& [flag, value] : kValues)
      if (std::string(flag) == option.flag) return value;
    if (const auto* number = std::get_if<NumberOption>(&option.value))
      return screenText(number->lowest + 0.37 * (std::min(number->highest, number->lowest + 100) - number->lowest), 1);
    if (const auto* whole = std::get_if<IntegerOption>(&option.value)) return std::to_string(whole->lowest + 1);
    if (const auto* either = std::get_if<SwitchOption>(&option.value))
      return optionText(option.value, Scene{}) == either->word_if_true ? either->word_if_false : either->word_if_true;
    if (const auto* words = std::get_if<WordOption>(&option.value)) return words->words.back();
    ADD_FAILURE() << option.flag << " has no value here";
    return {};
  };
  Scene scene;
  for (const SceneOption& option : sceneOptions()) setOption(option.value, valueOf(option), option.flag, scene);
  Scene again;
  const std::vector<std::string> words = sceneWords(scene);
  for (std::size_t n = 0; n < words.size(); ++n) {
    for (const SceneOption& option : sceneOptions()) {
      if (words[n] != option.flag) continue;
      const bool bare = isBare(option.value);
      setOption(option.value, bare ? std::get<SwitchOption>(option.value).word_if_true : words.at(n + 1), option.flag, again);
      if (!bare) ++n;
      break;
    }
  }
  for (const SceneOption& option : sceneOptions())
    EXPECT_EQ(optionText(option.value, again), optionText(option.value, scene)) << option.flag;
}

}  // namespace scene_words_test
}  // namespace palpate
