// SPDX-License-Identifier: Apache-2.0
#include "apps/scene/option_table.hpp"

#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/nearest_word.hpp"
#include "servo/algorithms/registry.hpp"
#include "tests/support/typo.hpp"

namespace palpate {
namespace option_table_test {

TEST(OptionTable, FlagsAndKeysAreUnique) {
  std::set<std::string> flags, keys;
  for (const SceneOption& option : sceneOptions()) {
    EXPECT_TRUE(flags.insert(option.flag).second) << option.flag;
    EXPECT_TRUE(keys.insert(option.key).second) << option.key;
    EXPECT_THAT(option.flag, testing::MatchesRegex("--[a-z][a-z-]*"));
    EXPECT_THAT(option.key, testing::MatchesRegex("([a-z]+[.])?[a-z][A-Za-z_]*"));
    EXPECT_STRNE(option.help, "") << option.flag;
  }
}

TEST(OptionTable, AFlagWithATypoIsRecognised) {
  std::vector<std::string> flags;
  for (const SceneOption& option : sceneOptions()) flags.emplace_back(option.flag);
  forEachTypo(flags, [&](const std::string& flag, const std::string& typed) {
    EXPECT_THAT(nearestWords(typed, flags), testing::Contains(flag)) << typed;
  });
}

TEST(OptionTable, HasTheFlagsThatArePromised) {
  std::set<std::string> flags;
  for (const SceneOption& option : sceneOptions()) flags.insert(option.flag);
  for (const char* flag : {"--iso",
                           "--n",
                           "--stiffness",
                           "--damping",
                           "--rate",
                           "--seconds",
                           "--hand",
                           "--path",
                           "--clock",
                           "--gpu",
                           "--friction-static",
                           "--texture",
                           "--recovery",
                           "--force-shading",
                           "--gradient",
                           "--algorithm",
                           "--out",
                           "--trace",
                           "--stopped-trace",
                           "--gpu-memory",
                           "--journal",
                           "--save",
                           "--save-every"}) {
    EXPECT_TRUE(flags.contains(flag)) << flag;
  }
}

// A key whose name ends in a unit and the unit on the screen are the same unit.
TEST(OptionTable, UnitsOfKeysAreThoseOnTheScreen) {
  const std::pair<const char*, const char*> kUnits[] = {
      {"_N_per_m", "N/m"}, {"_Ns_per_m", "N s/m"}, {"_hz", "Hz"}, {"_mm", "mm"},       {"_ms", "ms"},
      {"_kg", "kg"},       {"_N_per_s", "N/s"},    {"_N", "N"},   {"_ticks", "ticks"}, {"_s", "s"}};
  for (const SceneOption& option : sceneOptions()) {
    for (const auto& [ending, unit] : kUnits) {
      if (!std::string_view(option.key).ends_with(ending)) continue;
      EXPECT_STREQ(option.unit, unit) << option.key;
      break;
    }
  }
}

// What a number on the screen is worth in the code, by its unit: of every option, so that no millimetre is taken for a
// metre.
TEST(OptionTable, ScalesAreThoseOfTheUnits) {
  const std::map<std::string, double> kScales = {{"mm", 1e-3},
                                                 {"ms", 1e-3},
                                                 {"", 1},
                                                 {"N/m", 1},
                                                 {"N s/m", 1},
                                                 {"N/s", 1},
                                                 {"N", 1},
                                                 {"Hz", 1},
                                                 {"s", 1},
                                                 {"kg", 1},
                                                 {"A", 1},
                                                 {"deg", std::numbers::pi / 180},
                                                 {"density", 1},
                                                 {"density, N, N s/m", 1},
                                                 {"density/mm, -", 1e3}};
  for (const SceneOption& option : sceneOptions()) {
    double scale = 0;
    if (const auto* number = std::get_if<NumberOption>(&option.value))
      scale = number->scale;
    else if (const auto* vector = std::get_if<VectorOption>(&option.value))
      scale = vector->scale;
    else if (const auto* table = std::get_if<TableOption>(&option.value))
      scale = table->first_scale;
    else
      continue;
    ASSERT_TRUE(kScales.contains(option.unit)) << option.flag << " [" << option.unit << "]";
    EXPECT_DOUBLE_EQ(scale, kScales.at(option.unit)) << option.flag;
  }
}

// A flag without a unit in its key has the one that its help says: lengths are millimetres, times seconds, ticks whole.
TEST(OptionTable, UnitsAreThoseOfTheMeaning) {
  for (const auto& [flag, unit] : std::map<std::string, std::string>{{"--iso", "density"},
                                                                     {"--n", "ticks"},
                                                                     {"--seconds", "s"},
                                                                     {"--rate", "Hz"},
                                                                     {"--fade", "s"},
                                                                     {"--stale", "s"},
                                                                     {"--stall", "s"},
                                                                     {"--report-timeout", "s"},
                                                                     {"--velocity-noise", "mm"},
                                                                     {"--velocity-cutoff", "Hz"},
                                                                     {"--recovery", "ms"},
                                                                     {"--texture-amplitude", "mm"},
                                                                     {"--texture-wavelength", "mm"},
                                                                     {"--encoder", "mm"},
                                                                     {"--delay", "ticks"},
                                                                     {"--start", "mm"},
                                                                     {"--depth", "mm"},
                                                                     {"--slide", "mm"},
                                                                     {"--approach", "mm"},
                                                                     {"--save-every", "s"},
                                                                     {"--width", "pixel"},
                                                                     {"--height", "pixel"},
                                                                     {"--force-limit", "N"},
                                                                     {"--slew-limit", "N/s"},
                                                                     {"--hand-mass", "kg"},
                                                                     {"--stiffness", "N/m"},
                                                                     {"--damping", "N s/m"}}) {
    const auto options = sceneOptions();
    const auto found =
        std::find_if(options.begin(), options.end(), [&wanted = flag](const auto& o) { return wanted == o.flag; });
    ASSERT_NE(found, options.end()) << flag;
    EXPECT_EQ(found->unit, unit) << flag;
  }
}

// In words and in bits: what `palpate scene` prints as the default is what a run without the flag uses.
TEST(OptionTable, EveryDefaultIsAValueThatItsOptionTakes) {
  for (const SceneOption& option : sceneOptions()) {
    const std::string standard = optionText(option.value, Scene{});
    if (standard.empty()) continue;  // the program chooses
    Scene scene;
    EXPECT_NO_THROW(setOption(option.value, standard, option.flag, scene)) << option.flag;
    EXPECT_EQ(optionText(option.value, scene), standard) << option.flag;
  }
}

// The texts above have ten digits, so a default of more would not come back: bit for bit, every number.
TEST(OptionTable, EveryDefaultComesBackToTheSameBits) {
  for (const SceneOption& option : sceneOptions()) {
    const auto* number = std::get_if<NumberOption>(&option.value);
    if (number == nullptr || !std::holds_alternative<double Scene::*>(number->member)) continue;
    const auto member = std::get<double Scene::*>(number->member);
    Scene scene;
    scene.*member = -1;
    setOption(option.value, optionText(option.value, Scene{}), option.flag, scene);
    EXPECT_DOUBLE_EQ(scene.*member, Scene{}.*member) << option.flag;
  }
}

TEST(OptionTable, KeysAreFound) {
  for (const SceneOption& option : sceneOptions()) EXPECT_EQ(optionOfKey(option.key), &option);
  EXPECT_EQ(optionOfKey("servo"), nullptr);
  EXPECT_EQ(optionOfKey("servo.N"), nullptr);
  EXPECT_EQ(optionOfKey(""), nullptr);
}

TEST(OptionTable, HelpSaysUnitDefaultAndKey) {
  Scene usual;
  usual.rate_hz = 3000;
  EXPECT_EQ(optionHelp(*optionOfKey("servo.rate_hz"), usual),
            "servo rate [Hz] (a number from 10 to 20000; default 3000; key servo.rate_hz)");
  EXPECT_EQ(optionHelp(*optionOfKey("servo.stiffness_N_per_m")),
            "stiffness of the contact, K; if not given 500, or what a device that is held bears [N/m] (a number from 0 "
            "to 100000; "
            "key servo.stiffness_N_per_m)");
  EXPECT_EQ(optionHelp(*optionOfKey("hand.kind")),
            "rigid: the device is exactly on the path; "
            "spring: a hand pulls it and feels the force (rigid or spring; default rigid; key hand.kind)");
  EXPECT_EQ(optionHelp(*optionOfKey("gpu")), "part of the Vulkan device's name; the best one if not given (key gpu)");
  EXPECT_EQ(optionHelp(*optionOfKey("servo.require_real_time")),
            "refuse to start where the system gives no real-time priority or locks no memory (no value; "
            "key servo.require_real_time: off or on; default off)");
}

// A flag without a value would swallow none, or one with a value the volume behind it.
TEST(OptionTable, FourFlagsAloneHaveNoValue) {
  for (const SceneOption& option : sceneOptions()) {
    const std::string_view flag = option.flag;
    EXPECT_EQ(isBare(option.value),
              flag == "--require-real-time" || flag == "--calibrated" || flag == "--service" || flag == "--resample")
        << flag;
  }
}

// Words of the registry, so that no algorithm is missing where people look for its name.
TEST(OptionTable, HelpAndDocumentNameEveryAlgorithm) {
  for (const AlgorithmEntry& entry : algorithms()) {
    EXPECT_THAT(optionHelp(*optionOfKey("servo.algorithm")), testing::HasSubstr(std::string(entry.name)));
    EXPECT_THAT(sceneDocument(), testing::HasSubstr(fmt::format("\n| `{}` | {} |\n", entry.name, entry.description)));
  }
  EXPECT_EQ(Scene{}.algorithm, algorithms().front().name);
}

TEST(OptionTable, EveryOptionHasAGroup) {
  for (const SceneOption& option : sceneOptions()) EXPECT_STRNE(optionGroup(option), "") << option.key;
  EXPECT_STREQ(optionGroup(*optionOfKey("servo.n")), "Servo");
  EXPECT_STREQ(optionGroup(*optionOfKey("volume")), "Volume and what is computed of it");
}

TEST(OptionTable, WordsAreThoseThatAreTaken) {
  for (const SceneOption& option : sceneOptions()) {
    for (const std::string& word : optionWords(option.value)) {
      Scene scene;
      EXPECT_NO_THROW(setOption(option.value, word, option.flag, scene)) << option.flag << " " << word;
      EXPECT_THAT(optionForm(option.value), testing::HasSubstr(word));
    }
  }
  EXPECT_EQ(optionWords(optionOfKey("servo.algorithm")->value).size(), algorithms().size());
  EXPECT_THAT(optionWords(optionOfKey("servo.clock")->value), testing::ElementsAre("real", "simulated"));
  EXPECT_THAT(optionWords(optionOfKey("servo.n")->value), testing::IsEmpty());
}

TEST(SceneDocument, IsTheCommittedPage) {
  std::ifstream in(PALPATE_DOCS "/scene.md");
  const std::string page((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  EXPECT_EQ(page, sceneDocument()) << "run: palpate scene > docs/scene.md";
}

TEST(SceneDocument, HasARowForEachOption) {
  for (const SceneOption& option : sceneOptions()) {
    EXPECT_THAT(sceneDocument(), testing::HasSubstr(std::string("\n| `") + option.key + "` | `" + option.flag + "` | " +
                                                    option.unit + " |"));
  }
}

}  // namespace option_table_test
}  // namespace palpate
