// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/option_value.hpp"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace option_value_test {

// Every option of a scene as text, to see that nothing changed.
std::string everything(const Scene& scene) {
  std::string text;
  for (const SceneOption& option : sceneOptions()) text += optionText(option.value, scene) + "\n";
  return text;
}

void set(const char* key, const std::string& text, Scene& scene) {
  const SceneOption& option = *optionOfKey(key);
  setOption(option.value, text, option.flag, scene);
}

void expectRefused(const SceneOption& option, const std::string& text) {
  Scene scene;
  const std::string before = everything(scene);
  try {
    setOption(option.value, text, option.flag, scene);
    ADD_FAILURE() << option.flag << " took '" << text << "'";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), testing::StartsWith(std::string(option.flag) + ": "));
    EXPECT_THAT(error.what(), testing::HasSubstr("'" + text + "'"));
    EXPECT_THAT(error.what(), testing::EndsWith(" give " + optionForm(option.value)));
  }
  EXPECT_EQ(everything(scene), before) << option.flag;
}

template <typename Kind>
std::vector<const SceneOption*> optionsOfKind() {
  std::vector<const SceneOption*> options;
  for (const SceneOption& option : sceneOptions()) {
    if (std::holds_alternative<Kind>(option.value)) options.push_back(&option);
  }
  return options;
}

TEST(OptionValue, NumbersRefuseWhatIsNone) {
  for (const SceneOption* option : optionsOfKind<NumberOption>()) {
    for (const char* text : {"", " ", "x", "nan", "-nan", "inf", "-inf", "1e999", "5x", "5 ", "1,5", "0x10", "--1"}) {
      expectRefused(*option, text);
    }
  }
}

TEST(OptionValue, WholeNumbersRefuseWhatIsNone) {
  for (const SceneOption* option : optionsOfKind<IntegerOption>()) {
    for (const char* text : {"", "x", "nan", "5.5", "5.0", "5x", "1e3", "99999999999999999999"})
      expectRefused(*option, text);
  }
}

// The range is closed, or open below, as the words say: ends that belong to it are taken, what lies beyond is not.
TEST(OptionValue, NumbersKeepTheirRange) {
  for (const SceneOption* option : optionsOfKind<NumberOption>()) {
    const auto& range = std::get<NumberOption>(option->value);
    ASSERT_LT(range.lowest, range.highest) << option->flag;
    Scene scene;
    EXPECT_NO_THROW(setOption(option->value, fmt::format("{:.17g}", range.highest), option->flag, scene));
    EXPECT_EQ(range.above_lowest, optionForm(option->value) ==
                                      fmt::format("a number above {:g}, at most {:g}", range.lowest, range.highest));
    if (range.above_lowest) {
      EXPECT_NO_THROW(setOption(option->value, fmt::format("{:.17g}", range.lowest + 1e-9), option->flag, scene));
      expectRefused(*option, fmt::format("{:.17g}", range.lowest));
      continue;
    }
    EXPECT_NO_THROW(setOption(option->value, fmt::format("{:.17g}", range.lowest), option->flag, scene));
    expectRefused(*option, fmt::format("{:.17g}", range.lowest - std::max(1e-9, std::abs(range.lowest) * 1e-6)));
    expectRefused(*option, fmt::format("{:.17g}", range.highest * 1.000001));
  }
}

// A run can be repeated from its own words: they give the same number, bit for bit, and are short where that is.
TEST(OptionValue, WordsGiveTheNumberBack) {
  std::mt19937_64 random(4);
  const auto share = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };  // [0, 1), every bit of a double
  const auto back = [](double number, double scale) {
    const double si = number * scale;
    EXPECT_EQ(numberOf(screenText(si, scale)).value_or(0) * scale, si)
        << fmt::format("{:.17g} {}", number, screenText(si, scale));
  };
  for (const double scale : {1.0, 1e-3, 1e3}) {
    EXPECT_EQ(screenText(0.1 * scale, scale), "0.1");
    EXPECT_EQ(screenText(123.456789 * scale, scale), "123.456789");
    for (int n = 0; n < 20000; ++n) back((share() - 0.5) * std::pow(10, 20 * share() - 10), scale);
    for (const double number : {0.0, 5e-324, 1e-310, 1e-300, 1.7e305, -1.7e305}) back(number, scale);
  }
  for (const SceneOption* option : optionsOfKind<NumberOption>()) {
    const auto& range = std::get<NumberOption>(option->value);
    for (int n = 0; n < 50; ++n) {
      const double number =
          std::clamp(range.lowest + share() * (range.highest - range.lowest), range.lowest, range.highest);
      Scene scene, again;
      setOption(option->value, fmt::format("{:.17g}", number), option->flag, scene);
      setOption(option->value, optionText(option->value, scene), option->flag, again);
      const auto value = [&](const Scene& of) {
        return std::visit([&](auto member) { return std::optional<double>(of.*member); }, range.member);
      };
      EXPECT_EQ(value(again), value(scene)) << option->flag;
    }
  }
}

TEST(OptionValue, TablesRefuseWhatIsTooLargeInTheirUnit) {
  expectRefused(*optionOfKey("haptization.gradient"), "1e308:1");
}

TEST(OptionValue, WholeNumbersKeepTheirRange) {
  for (const SceneOption* option : optionsOfKind<IntegerOption>()) {
    const auto& range = std::get<IntegerOption>(option->value);
    Scene scene;
    EXPECT_NO_THROW(setOption(option->value, std::to_string(range.lowest), option->flag, scene));
    EXPECT_NO_THROW(setOption(option->value, std::to_string(range.highest), option->flag, scene));
    expectRefused(*option, std::to_string(range.lowest - 1));
    expectRefused(*option, std::to_string(range.highest + 1));
  }
}

TEST(OptionValue, SwitchesTakeTheirTwoWordsOnly) {
  for (const SceneOption* option : optionsOfKind<SwitchOption>()) {
    const auto& words = std::get<SwitchOption>(option->value);
    for (const char* word : {words.word_if_false, words.word_if_true}) {
      Scene scene;
      setOption(option->value, word, option->flag, scene);
      EXPECT_EQ(scene.*words.member, word == words.word_if_true);
      EXPECT_EQ(optionText(option->value, scene), word);
      expectRefused(*option, std::string(word) + " ");
    }
    for (const char* text : {"", "1", "true", "maybe"}) expectRefused(*option, text);
  }
}

TEST(OptionValue, WordsAreTakenFromTheirListOnly) {
  ASSERT_FALSE(optionsOfKind<WordOption>().empty());
  for (const SceneOption* option : optionsOfKind<WordOption>()) {
    const auto& words = std::get<WordOption>(option->value);
    ASSERT_FALSE(words.words.empty());
    EXPECT_EQ(optionText(option->value, Scene{}), words.words.front());
    for (const char* word : words.words) {
      Scene scene;
      setOption(option->value, word, option->flag, scene);
      EXPECT_EQ(scene.*words.member, word);
      EXPECT_EQ(optionText(option->value, scene), word);
      expectRefused(*option, std::string(word) + " ");
    }
    for (const char* text : {"", "1", "maybe"}) expectRefused(*option, text);
  }
  EXPECT_EQ(optionForm(optionOfKey("contact.texture")->value), "none, procedural or density");
}

TEST(OptionValue, AWordWithATypoIsRecognised) {
  for (const SceneOption& option : sceneOptions()) {
    forEachTypo(optionWords(option.value), [&](const std::string& word, const std::string& typed) {
      Scene scene;
      const std::string message = refusalOf([&] { setOption(option.value, typed, option.flag, scene); });
      EXPECT_THAT(suggestedIn(message), testing::HasSubstr(word)) << message;
    });
  }
  Scene scene;
  EXPECT_EQ(refusalOf([&] { setOption(optionOfKey("servo.algorithm")->value, "blezeck", "--algorithm", scene); }),
            "--algorithm: 'blezeck' is not what it takes; did you mean blezek? give " +
                optionForm(optionOfKey("servo.algorithm")->value));
}

// Where a name alone makes sense, '' is a slip: of a variable of a script that is not set, say.
TEST(OptionValue, TextsThatMustNameSomethingAreNotEmpty) {
  std::vector<std::string> may_be_empty;
  for (const SceneOption* option : optionsOfKind<TextOption>()) {
    Scene scene;
    setOption(option->value, "a b", option->flag, scene);
    EXPECT_EQ(optionText(option->value, scene), "a b");
    const std::string message = refusalOf([&] { setOption(option->value, "", option->flag, scene); });
    if (message == kNoRefusal) {
      may_be_empty.emplace_back(option->flag);
      EXPECT_EQ(optionText(option->value, scene), "");
    } else {
      EXPECT_EQ(message, std::string(option->flag) + ": '' is empty; give text, or leave it out");
      EXPECT_EQ(optionText(option->value, scene), "a b");
    }
  }
  EXPECT_THAT(may_be_empty, testing::ElementsAre("--volume", "--gpu", "--gradient-operator", "--out"));
}

TEST(OptionValue, RefusalsSayTheUnit) {
  Scene scene;
  EXPECT_EQ(refusalOf([&] { setOption(optionOfKey("path.depth_mm")->value, "5um", "--depth", scene, "mm"); }),
            "--depth: '5um' is not what it takes; give a number from 0 to 100, in mm");
}

TEST(OptionValue, VectorsTakeThreeNumbers) {
  for (const SceneOption* option : optionsOfKind<VectorOption>()) {
    for (const char* text : {"", "1", "1,2", "1,2,3,4", "1,2,", ",,", "1,2,x", "1,2,nan", "1,inf,3", "1;2;3"}) {
      expectRefused(*option, text);
    }
    Scene scene;
    EXPECT_NO_THROW(setOption(option->value, " 1, -2 ,3e-1", option->flag, scene));
  }
}

TEST(OptionValue, DirectionsAreMadeUnitVectorsOfAnyLength) {
  for (const char* text : {"3,0,-4", "3e200,0,-4e200", "3e-200,0,-4e-200"}) {
    Scene scene;
    set("path.toward", text, scene);
    ASSERT_TRUE(scene.path_toward) << text;
    EXPECT_NEAR((*scene.path_toward - Vec3(0.6, 0, -0.8)).norm(), 0, 1e-15) << text;
  }
  Scene scene;
  set("path.toward", "0,-2,0", scene);
  EXPECT_EQ(optionText(optionOfKey("path.toward")->value, scene), "0,-1,0");
  expectRefused(*optionOfKey("path.toward"), "0,0,0");
  expectRefused(*optionOfKey("path.slide_toward"), "0,-0,0");
}

TEST(OptionValue, ScreenUnitsBecomeTheCodesUnits) {
  Scene scene;
  set("path.depth_mm", "2.5", scene);
  set("path.start_mm", "1,-2,3", scene);
  set("device.encoder_resolution_mm", "0.01", scene);
  EXPECT_DOUBLE_EQ(scene.press_depth_m.value(), 2.5e-3);
  EXPECT_DOUBLE_EQ(scene.encoder_resolution_m, 1e-5);
  EXPECT_NEAR((*scene.path_start_W - Vec3(1e-3, -2e-3, 3e-3)).norm(), 0, 1e-18);
  EXPECT_EQ(optionText(optionOfKey("path.depth_mm")->value, scene), "2.5");
  EXPECT_EQ(optionText(optionOfKey("path.start_mm")->value, scene), "1,-2,3");
}

TEST(OptionValue, TablesTakeRowsOfNumbers) {
  Scene scene;
  EXPECT_EQ(optionText(optionOfKey("haptization.density")->value, scene), "");
  set("haptization.density", "-1000:0:0, 200 : 0.5:1 ,1e3:2:0", scene);
  EXPECT_EQ(scene.haptization_density, (NumberTable{{-1000, 0, 0}, {200, 0.5, 1}, {1000, 2, 0}}));
  EXPECT_EQ(optionText(optionOfKey("haptization.density")->value, scene), "-1000:0:0,200:0.5:1,1000:2:0");
  set("haptization.gradient", "0:0,50:1", scene);  // density per millimetre
  EXPECT_EQ(scene.haptization_gradient, (NumberTable{{0, 0}, {50000, 1}}));
  EXPECT_EQ(optionText(optionOfKey("haptization.gradient")->value, scene), "0:0,50:1");
}

TEST(OptionValue, TablesRefuseWhatIsNone) {
  for (const char* text : {"", " ", "1", "1:2", "1:2:3:4", "1:2:3,", ",1:2:3", "1:2:3,4:5", "1:2:x", "1:2:nan",
                           "1:inf:3", "1::3", "1:2:3;4:5:6"}) {
    expectRefused(*optionOfKey("haptization.density"), text);
  }
  expectRefused(*optionOfKey("haptization.gradient"), "1:2:3");
}

TEST(OptionValue, ChosenValuesAreEmptyUntilGiven) {
  Scene scene;
  EXPECT_EQ(optionText(optionOfKey("isovalue")->value, scene), "");
  set("isovalue", "-300", scene);
  EXPECT_EQ(scene.isovalue, -300);
  EXPECT_EQ(optionText(optionOfKey("isovalue")->value, scene), "-300");
}

}  // namespace option_value_test
}  // namespace palpate
