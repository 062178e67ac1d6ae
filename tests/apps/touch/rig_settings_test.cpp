// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/rig_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace rig_settings_test {

Scene with(const std::vector<std::pair<const char*, std::string>>& values) {
  Scene scene;
  for (const auto& [key, text] : values) setOption(optionOfKey(key)->value, text, key, scene);
  return scene;
}

ContactEffects effectsOf(const Scene& scene) {
  const RigSettings settings = rigSettings(scene, 0);
  return makeContactEffects(settings.effects, settings.parameters.stiffness_N_per_m, settings.parameters.rate_hz);
}

std::string refusal(const Scene& scene) {
  return refusalOf([&] { static_cast<void>(effectsOf(scene)); });
}

TEST(RigSettingsOfScene, CarriesWhatTheSceneAsks) {
  Scene scene;
  scene.stiffness_N_per_m = 7;
  scene.damping_Ns_per_m = 3;
  scene.plane_renewal_ticks = 9;
  scene.rate_hz = 4000;
  scene.haptization_density = {{-1000, 0.5, 1}, {200, 2, 3}};
  scene.haptization_gradient = {{0, 0}, {5e4, 1}};
  scene.algorithm = "avila";
  scene.force_limit_N = 3.5;
  const RigSettings setup = rigSettings(scene, 42);
  EXPECT_EQ(setup.algorithm, "avila");
  EXPECT_EQ(setup.force_limit_N, 3.5);
  EXPECT_EQ(setup.parameters.isovalue, 42);
  EXPECT_EQ(setup.parameters.stiffness_N_per_m, 7);
  EXPECT_EQ(setup.parameters.damping_Ns_per_m, 3);
  EXPECT_EQ(setup.parameters.plane_renewal_ticks, 9);
  EXPECT_EQ(setup.parameters.rate_hz, 4000);
  ASSERT_EQ(setup.haptization.density.size(), 2u);
  EXPECT_EQ(setup.haptization.density[1].density, 200);
  EXPECT_EQ(setup.haptization.density[1].force_N, 2);
  EXPECT_EQ(setup.haptization.density[1].viscosity_Ns_per_m, 3);
  ASSERT_EQ(setup.haptization.gradient.size(), 2u);
  EXPECT_EQ(setup.haptization.gradient[1].gradient_per_m, 5e4);
  EXPECT_EQ(setup.haptization.gradient[1].weight, 1);
}

// K T / 2 + K T d of the stiffest that it may be.
TEST(RigSettingsOfScene, SaysWhatTheWallLacksInDamping) {
  Scene scene;
  scene.stiffness_N_per_m = 2000;
  scene.damping_Ns_per_m = 0.25;
  scene.rate_hz = 4000;
  EXPECT_DOUBLE_EQ(lackingDamping(scene), 0);
  scene.damping_Ns_per_m = 0.125;
  EXPECT_DOUBLE_EQ(lackingDamping(scene), 0.125);
  scene.device_delay_ticks = 3;
  EXPECT_DOUBLE_EQ(lackingDamping(scene), 0.125 + 1.5);
  scene.device_delay_ticks = 0;
  scene.stiffness_density = {{0, 0.5}, {10, 3}, {20, 1}};
  EXPECT_DOUBLE_EQ(lackingDamping(scene), 0.75 - 0.125);
  scene.algorithm = "haptization";
  EXPECT_EQ(lackingDamping(scene), 0);
}

TEST(RigSettingsOfScene, ASceneThatAsksForNoEffectGetsNone) {
  EXPECT_TRUE(effectsOf(Scene{}).empty());
}

TEST(RigSettingsOfScene, EachEffectComesFromItsOption) {
  for (const auto& [key, text] :
       std::initializer_list<std::pair<const char*, const char*>>{{"contact.force_shading", "on"},
                                                                  {"contact.recovery_ms", "20"},
                                                                  {"contact.texture", "procedural"},
                                                                  {"contact.texture", "density"},
                                                                  {"contact.friction_static", "0.5"},
                                                                  {"contact.friction_viscous_Ns_per_m", "1"},
                                                                  {"contact.stiffness_density", "200:0.3,700:1"}}) {
    EXPECT_EQ(effectsOf(with({{key, text}})).size(), 1u) << key;
  }
}

TEST(RigSettingsOfScene, EveryTextureOfTheTableIsKnown) {
  for (const char* word : std::get<WordOption>(optionOfKey("contact.texture")->value).words) {
    EXPECT_EQ(refusal(with({{"contact.texture", word}})), kNoRefusal) << word;
  }
}

TEST(RigSettingsOfScene, EffectsThatCannotBeMadeAreRefused) {
  EXPECT_THAT(refusal(with({{"contact.friction_dynamic", "0.3"}})), testing::HasSubstr("dynamic friction: 0.3"));
  EXPECT_THAT(refusal(with({{"contact.stiffness_density", "5:1,4:1"}})), testing::HasSubstr("rising order"));
}

}  // namespace rig_settings_test
}  // namespace palpate
