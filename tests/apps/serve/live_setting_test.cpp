// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_setting.hpp"

#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "apps/servo_setup/scene_settings.hpp"
#include "base/error.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace live_setting_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A key is live if, and only if, what the rig takes between two ticks (RigSettings) knows it, or it is the isovalue;
// nothing else may depend on it that is made once.
TEST(LiveSetting, KnowsEveryKeyThatTheRigTakes) {
  for (const char* key : {"isovalue", "servo.algorithm", "servo.n", "servo.stiffness_N_per_m", "servo.damping_Ns_per_m",
                          "safety.force_limit_N", "contact.texture", "contact.friction_static", "haptization.density"})
    EXPECT_TRUE(isLiveKey(key)) << key;
  for (const SceneOption& option : sceneOptions()) {
    const std::string key = option.key;
    const bool is_table = key.starts_with("contact.") || key.starts_with("haptization.");
    if (isLiveKey(key) || is_table) continue;
    for (const char* text : {"1", "2", "0.5", "yes", "on", "spring", "half", "hri"}) {
      Scene before, after;
      try {
        setOption(option.value, text, key, after, option.unit);
      } catch (const Error&) {
        continue;  // no value of its kind
      }
      if (key == "servo.rate_hz") continue;  // which the loop is made with
      EXPECT_EQ(rigSettings(before, 0), rigSettings(after, 0)) << key;
    }
  }
}

TEST(LiveSetting, SetsOneKey) {
  const Scene scene = withLiveSetting(Scene{}, "servo.stiffness_N_per_m", "250");
  EXPECT_EQ(stiffnessOf(scene), 250);
  EXPECT_EQ(withLiveSetting(Scene{}, "servo.n", "9").plane_renewal_ticks, 9);
}

// Of a window, whose settings come as numbers.
TEST(LiveSetting, ChecksWhatDiffers) {
  const auto refusal = [](double Scene::*setting, double value) {
    Scene next;
    next.*setting = value;
    return refusalOf([&] { checkLiveSettings(Scene{}, next); });
  };
  for (const double limit :
       {-1.0, 1e6, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THAT(refusal(&Scene::force_limit_N, limit), HasSubstr("safety.force_limit_N")) << limit;
  Scene next;
  next.force_limit_N = 2;
  next.plane_renewal_ticks = 7;
  EXPECT_NO_THROW(checkLiveSettings(Scene{}, next));
  next.rate_hz = -5;  // which no window changes
  EXPECT_NO_THROW(checkLiveSettings(Scene{}, next));
}

TEST(LiveSetting, RefusesOtherKeysAndValues) {
  const auto refusal = [](const char* key, const char* value) {
    return refusalOf([&] { static_cast<void>(withLiveSetting(Scene{}, key, value)); });
  };
  EXPECT_THAT(refusal("servo.rate_hz", "500"), HasSubstr("it cannot change while the scene is served"));
  EXPECT_THAT(refusal("volume", "a.vdb"), HasSubstr("it cannot change"));
  EXPECT_THAT(refusal("servo.stifness_N_per_m", "5"), HasSubstr("did you mean"));
  EXPECT_THAT(refusal("", "5"), HasSubstr("no setting of a scene has this key"));
  EXPECT_THAT(refusal("servo.n", "0"), HasSubstr("servo.n"));
  EXPECT_THAT(refusal("servo.n", "nan"), HasSubstr("servo.n"));
  EXPECT_THAT(refusal("safety.force_limit_N", "-1"), HasSubstr("safety.force_limit_N"));
}

// A scene's file that was read again: live settings are taken, the others named.
TEST(LiveSetting, TakesWhatMayChangeOfAFile) {
  Scene scene, wanted;
  scene.plane_renewal_ticks = 3;
  wanted.plane_renewal_ticks = 8;
  wanted.friction_static = 0.3;
  wanted.rate_hz = 500;
  std::vector<std::string> others;
  const Scene next = withLiveSettings(scene, wanted, others);
  EXPECT_EQ(next.plane_renewal_ticks, 8);
  EXPECT_EQ(next.friction_static, 0.3);
  EXPECT_EQ(next.rate_hz, scene.rate_hz);
  EXPECT_THAT(others, ElementsAre("servo.rate_hz"));
  others.clear();
  static_cast<void>(withLiveSettings(scene, scene, others));
  EXPECT_THAT(others, IsEmpty());
}

TEST(LiveSetting, PrintsSettings) {
  Scene scene;
  scene.plane_renewal_ticks = 7;
  const std::vector<std::string> key = {"servo.n"};
  EXPECT_EQ(settingsText(scene, key), "servo.n = 7\n");
  const std::string all = settingsText(scene, {});
  const std::size_t others = all.find("\n# these cannot change");
  ASSERT_NE(others, std::string::npos);
  EXPECT_THAT(all, StartsWith("# 'palpate ctl set' changes these:\n"));
  for (const SceneOption& option : sceneOptions()) {
    const std::size_t at = all.find(fmt::format("\n{} = {}\n", option.key, optionText(option.value, scene)));
    ASSERT_NE(at, std::string::npos) << option.key;
    EXPECT_EQ(at < others, isLiveKey(option.key)) << option.key;
  }
  const std::vector<std::string> none = {"servo.m"};
  EXPECT_THAT(refusalOf([&] { static_cast<void>(settingsText(scene, none)); }), HasSubstr("no setting"));
}

}  // namespace live_setting_test
}  // namespace palpate
