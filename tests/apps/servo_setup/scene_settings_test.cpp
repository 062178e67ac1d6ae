// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_setup/scene_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/scene/option_table.hpp"
#include "servo/devices/path.hpp"
#include "tests/support/any_settings.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace scene_settings_test {

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

// There and back, to the bit; the rate is the scene's.
TEST(RigSettingsOfScene, AreThoseThatItWasGiven) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Seeded random(seed);
    Scene scene = withRigSettings(Scene{}, anySettings(random));  // others before
    RigSettings given = anySettings(random);
    given.parameters.rate_hz = scene.rate_hz;
    scene = withRigSettings(scene, given);
    EXPECT_EQ(scene.isovalue, given.parameters.isovalue) << seed;
    EXPECT_EQ(rigSettings(scene, *scene.isovalue), given) << seed;
  }
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
  EXPECT_DOUBLE_EQ(lackingDamping(scene, {}), 0);
  scene.damping_Ns_per_m = 0.125;
  EXPECT_DOUBLE_EQ(lackingDamping(scene, {}), 0.125);
  EXPECT_DOUBLE_EQ(lackingDamping(scene, {.force_delay_ticks = 3}), 0.125 + 1.5);
  scene.stiffness_density = {{0, 0.5}, {10, 3}, {20, 1}};
  EXPECT_DOUBLE_EQ(lackingDamping(scene, {}), 0.75 - 0.125);
  scene.algorithm = "haptization";
  EXPECT_EQ(lackingDamping(scene, {}), 0);
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

TEST(RigSettingsOfScene, EffectsTakeTheirFiguresFromTheScene) {
  Scene scene;
  scene.force_shading = true;
  scene.recovery_s = 1.5;
  scene.texture = "density";
  scene.texture_amplitude_m = 2.5;
  scene.texture_wavelength_m = 3.5;
  scene.texture_gain = 4.5;
  scene.friction_static = 5.5;
  scene.friction_dynamic = 6.5;
  scene.friction_viscous_Ns_per_m = 7.5;
  scene.stiffness_density = {{200, 0.3}, {700, 1}};
  const EffectParameters wanted{
      .force_shading = true,
      .recovery_s = 1.5,
      .texture = TextureKind::kDensity,
      .texture_amplitude_m = 2.5,
      .texture_wavelength_m = 3.5,
      .texture_gain = 4.5,
      .friction = {.static_ratio = 5.5, .dynamic_ratio = 6.5, .viscous_Ns_per_m = 7.5},
      .stiffness_by_density = {{.density = 200, .factor = 0.3}, {.density = 700, .factor = 1}}};
  EXPECT_EQ(effectParameters(scene), wanted);
  EXPECT_EQ(rigSettings(scene, 0).effects, wanted);
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

// Whoever makes a loop or settings without a scene, as the window does, gets what an empty scene asks for.
TEST(ServoSetup, AnEmptySceneHasTheServosOwnDefaults) {
  const Scene empty;
  const LoopParameters loop = loopParameters(empty), own;
  EXPECT_EQ(loop.rate_hz, own.rate_hz);
  EXPECT_EQ(loop.ticks, own.ticks);
  EXPECT_EQ(loop.require_real_time, own.require_real_time);
  EXPECT_EQ(loop.velocity.name, own.velocity.name);
  EXPECT_EQ(loop.velocity.cutoff_hz, own.velocity.cutoff_hz);
  EXPECT_EQ(loop.velocity.noise_m, own.velocity.noise_m);
  EXPECT_EQ(loop.safety.force_limit_N, own.safety.force_limit_N);
  EXPECT_EQ(loop.safety.slew_limit_N_per_s, own.safety.slew_limit_N_per_s);
  EXPECT_EQ(loop.safety.fade_s, own.safety.fade_s);
  EXPECT_EQ(loop.safety.stale_window_s, own.safety.stale_window_s);
  EXPECT_EQ(loop.safety.stall_s, own.safety.stall_s);
  EXPECT_EQ(loop.safety.report_timeout_s, own.safety.report_timeout_s);
  EXPECT_EQ(loop.passivity.control, own.passivity.control);
  EXPECT_EQ(loop.instability.act, own.instability.act);
  EXPECT_TRUE(rigSettings(empty, RigSettings{}.parameters.isovalue) == RigSettings{});
}

// Every option that a running servo may change: of a rig with its own defaults, it is at the scene's default.
TEST(ServoSetup, TheOptionTableHasTheServosDefaults) {
  const Scene empty, rig = withRigSettings({}, RigSettings{});
  for (const SceneOption& option : sceneOptions()) {
    const bool may_be_empty = option.key == std::string_view("isovalue") ||  // chosen from the volume
                              option.key == std::string_view("servo.stiffness_N_per_m") ||
                              option.key == std::string_view("servo.damping_Ns_per_m");  // or what a device bears
    EXPECT_TRUE(may_be_empty || isSame(option.value, rig, empty)) << option.key;
  }
  EXPECT_EQ(stiffnessOf(empty), *rig.stiffness_N_per_m);
  EXPECT_EQ(dampingOf(empty), *rig.damping_Ns_per_m);
}

// A default that its own option refuses could not be given.
TEST(ServoSetup, DefaultsAreWithinTheirOptionsRanges) {
  const Scene empty = withRigSettings({}, RigSettings{});
  for (const SceneOption& option : sceneOptions()) {
    const std::string text = optionText(option.value, empty);
    Scene back;
    if (text.empty()) continue;
    EXPECT_NO_THROW(setOption(option.value, text, option.key, back, option.unit)) << option.key;
  }
  EXPECT_THROW(static_cast<void>(usualOfDevice("any_key")), std::logic_error);
}

// Of two who change different settings at once neither undoes the other's; of the same setting the last one counts.
TEST(RigSettingsOfScene, OnlyWhatWasChangedIsChanged) {
  Seeded random(7);
  for (int i = 0; i < 300; ++i) {
    const RigSettings before = anySettings(random);
    RigSettings present = anySettings(random), wanted = before;
    EXPECT_TRUE(withChanges(present, before, wanted) == present);
    wanted.parameters.stiffness_N_per_m += 1;
    RigSettings expected = present;
    expected.parameters.stiffness_N_per_m = wanted.parameters.stiffness_N_per_m;
    EXPECT_TRUE(withChanges(present, before, wanted) == expected);
    wanted.effects.friction.dynamic_ratio += 1;  // and nothing follows from it
    expected.effects.friction.dynamic_ratio = wanted.effects.friction.dynamic_ratio;
    EXPECT_TRUE(withChanges(present, before, wanted) == expected);
    wanted.haptization.density = {{1, 2, 3}};
    wanted.effects.stiffness_by_density.clear();
    expected.haptization.density = wanted.haptization.density;
    if (!before.effects.stiffness_by_density.empty()) expected.effects.stiffness_by_density.clear();
    EXPECT_TRUE(withChanges(present, before, wanted) == expected);
    RigSettings all = withChanges(present, before, anySettings(random));
    EXPECT_EQ(all.parameters.rate_hz, present.parameters.rate_hz);
  }
}

TEST(ServoSetup, LoopTakesWhatTheSceneAsksFor) {
  Scene scene;
  scene.rate_hz = 1234;
  scene.duration_s = 2.5;
  scene.force_limit_N = 1.5;
  scene.slew_limit_N_per_s = 2.5;
  scene.fade_s = 3.5;
  scene.stale_window_s = 4.5;
  scene.stall_s = 5.5;
  scene.report_timeout_s = 6.5;
  scene.velocity = "foaw";
  scene.velocity_cutoff_hz = 7.5;
  scene.velocity_noise_m = 8.5;
  scene.passivity_control = true;
  scene.require_real_time = true;
  const LoopParameters loop = loopParameters(scene);
  EXPECT_EQ(loop.rate_hz, 1234);
  EXPECT_EQ(loop.ticks, 3085);
  EXPECT_EQ(loop.safety.force_limit_N, 1.5);
  EXPECT_EQ(loop.safety.slew_limit_N_per_s, 2.5);
  EXPECT_EQ(loop.safety.fade_s, 3.5);
  EXPECT_EQ(loop.safety.stale_window_s, 4.5);
  EXPECT_EQ(loop.safety.stall_s, 5.5);
  EXPECT_EQ(loop.safety.report_timeout_s, 6.5);
  EXPECT_EQ(loop.velocity.name, "foaw");
  EXPECT_EQ(loop.velocity.cutoff_hz, 7.5);
  EXPECT_EQ(loop.velocity.noise_m, 8.5);
  EXPECT_TRUE(loop.passivity.control);
  EXPECT_TRUE(loop.real_time);
  EXPECT_TRUE(loop.require_real_time);
  EXPECT_FALSE(loopParameters(Scene{}).passivity.control);
  EXPECT_FALSE(loopParameters(Scene{}).require_real_time);
  EXPECT_FALSE(loopParameters(Scene{}).velocity.noise_m.has_value());
}

TEST(ServoSetup, DeviceTakesWhatTheSceneAsksFor) {
  Scene scene;
  scene.spring_hand = true;
  scene.hand_mass_kg = 1.5;
  scene.hand_damping_Ns_per_m = 2.5;
  scene.hand_stiffness_N_per_m = 3.5;
  scene.device_mass_kg = 4.5;
  scene.device_damping_Ns_per_m = 5.5;
  scene.force_limit_N = 6.5;
  scene.encoder_resolution_m = 7.5;
  scene.device_delay_ticks = 8;
  scene.rate_hz = 9.5;
  const SampledPath path({0, 1}, {Vec3::Zero(), Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  const DeviceSetup setup = deviceSetup(scene, path);
  EXPECT_EQ(setup.path, &path);
  EXPECT_EQ(setup.rate_hz, 9.5);
  const DeviceValues wanted = {
      {"spring_hand", 1}, {"hand_mass_kg", 1.5},     {"hand_damping_Ns_per_m", 2.5}, {"hand_stiffness_N_per_m", 3.5},
      {"mass_kg", 4.5},   {"damping_Ns_per_m", 5.5}, {"force_limit_N", 6.5},         {"encoder_resolution_m", 7.5},
      {"delay_ticks", 8}};
  EXPECT_EQ(setup.values, wanted);
}

// A scene that names nothing leaves all to the device but the force limit, which the gate has too.
TEST(ServoSetup, DeviceOfAnEmptySceneHasItsUsualValues) {
  const SampledPath path({0, 1}, {Vec3::Zero(), Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  const Scene scene;
  const DeviceValues wanted = {{"force_limit_N", deviceParameter(scene.device, "force_limit_N").usual}};
  EXPECT_EQ(deviceSetup(scene, path).values, wanted);
}

// Each device can be made for a scene that names it and nothing else.
TEST(ServoSetup, EveryDeviceCanBeMadeByItsName) {
  const SampledPath path({0, 1}, {Vec3::Zero(), Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  for (const DeviceEntry& entry : devices()) {
    if (entry.needs_port || entry.name == "recorded") continue;  // makeSceneDevice() opens those
    Scene scene;
    scene.device = entry.name;
    EXPECT_EQ(refusalOf([&] { static_cast<void>(makeDevice(scene.device, deviceSetup(scene, path))); }), kNoRefusal)
        << entry.name;
  }
}

}  // namespace scene_settings_test
}  // namespace palpate
