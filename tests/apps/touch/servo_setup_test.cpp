// SPDX-License-Identifier: Apache-2.0
// Every member of a scene that loop and device take, each with a value of its own.
#include "apps/touch/servo_setup.hpp"

#include <gtest/gtest.h>

#include "servo/devices/sampled_path.hpp"

namespace palpate {
namespace servo_setup_test {

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
  EXPECT_EQ(deviceSetup(Scene{}, path).values.at("spring_hand"), 0);
}

// A scene that names nothing has the default device as its registry has it.
TEST(ServoSetup, DeviceOfAnEmptySceneHasItsUsualValues) {
  const SampledPath path({0, 1}, {Vec3::Zero(), Vec3::Zero()}, SampledPath::Interpolation::kLinear);
  const Scene scene;
  const DeviceSetup setup = deviceSetup(scene, path);
  EXPECT_EQ(setup.values.size(), deviceEntry(scene.device).parameters().size());
  for (const auto& [key, value] : setup.values) EXPECT_EQ(value, deviceParameter(scene.device, key).usual) << key;
}

}  // namespace servo_setup_test
}  // namespace palpate
