// SPDX-License-Identifier: Apache-2.0
#include "apps/touch/algorithm_setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "base/error.hpp"

namespace palpate {
namespace {

Scene with(const std::vector<std::pair<const char*, std::string>>& values) {
  Scene scene;
  for (const auto& [key, text] : values) setOption(optionOfKey(key)->value, text, key, scene);
  return scene;
}

std::string refusal(const Scene& scene) {
  try {
    static_cast<void>(algorithmSetup(scene, 0));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    return error.what();
  }
  return "accepted";
}

TEST(AlgorithmSetup, TakesTheServosNumbersFromTheScene) {
  const Scene scene = with({{"servo.n", "7"}, {"servo.stiffness_N_per_m", "900"}, {"servo.damping_Ns_per_m", "2"}});
  const AlgorithmSetup setup = algorithmSetup(scene, 226);
  EXPECT_EQ(setup.parameters.isovalue, 226);
  EXPECT_EQ(setup.parameters.plane_renewal_ticks, 7);
  EXPECT_EQ(setup.parameters.stiffness_N_per_m, 900);
  EXPECT_EQ(setup.parameters.damping_Ns_per_m, 2);
}

TEST(AlgorithmSetup, ASceneThatAsksForNoEffectGetsNone) {
  EXPECT_TRUE(algorithmSetup(Scene{}, 0).effects.empty());
}

TEST(AlgorithmSetup, EachEffectComesFromItsOption) {
  for (const auto& [key, text] :
       std::initializer_list<std::pair<const char*, const char*>>{{"contact.force_shading", "on"},
                                                                  {"contact.recovery_ms", "20"},
                                                                  {"contact.texture", "procedural"},
                                                                  {"contact.texture", "density"},
                                                                  {"contact.friction_static", "0.5"},
                                                                  {"contact.friction_viscous_Ns_per_m", "1"},
                                                                  {"contact.stiffness_density", "200:0.3,700:1"}}) {
    EXPECT_EQ(algorithmSetup(with({{key, text}}), 0).effects.size(), 1u) << key;
  }
}

TEST(AlgorithmSetup, EveryTextureOfTheTableIsKnown) {
  for (const char* word : std::get<WordOption>(optionOfKey("contact.texture")->value).words) {
    EXPECT_EQ(refusal(with({{"contact.texture", word}})), "accepted") << word;
  }
}

TEST(AlgorithmSetup, EffectsThatCannotBeMadeAreRefused) {
  EXPECT_THAT(refusal(with({{"contact.friction_dynamic", "0.3"}})), testing::HasSubstr("dynamic friction: 0.3"));
  EXPECT_THAT(refusal(with({{"contact.stiffness_density", "bone"}})), testing::HasSubstr("'bone' is no row"));
  EXPECT_THAT(refusal(with({{"contact.stiffness_density", "5:1,4:1"}})), testing::HasSubstr("rising order"));
}

}  // namespace
}  // namespace palpate
