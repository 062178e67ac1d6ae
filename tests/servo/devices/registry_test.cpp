// SPDX-License-Identifier: Apache-2.0
// Devices by name: the same as those that are made by their type, and what is refused.
#include "servo/devices/registry.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/path.hpp"
#include "servo/devices/simulated_device.hpp"
#include "tests/servo/support/seeded.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace registry_test {

using testing::HasSubstr;

SampledPath wavyPath() {
  std::vector<double> times;
  std::vector<Vec3> points;
  for (int i = 0; i <= 100; ++i) {
    times.push_back(0.002 * i);
    points.push_back(0.01 * Vec3(std::sin(0.3 * i), std::cos(0.17 * i), 0.1 * i));
  }
  return {times, points, SampledPath::Interpolation::kLinear};
}

// Positions under the same forces, and what it says of itself.
std::vector<Vec3> felt(Device& device) {
  std::vector<Vec3> all = {
      Vec3(device.limits().force_limit_N, device.limits().position_resolution_m, device.limits().force_delay_ticks)};
  Seeded random(4);
  for (int tick = 0; tick < 200; ++tick) {
    if (tick > 0) device.elapse(1);
    Vec3 position_W = Vec3::Zero();
    EXPECT_TRUE(device.read(position_W));
    all.push_back(position_W);
    EXPECT_TRUE(device.write(Vec3(random.between(-9, 9), random.between(-9, 9), 1)));
  }
  return all;
}

// Random values for each parameter, and now and then none.
TEST(DeviceRegistry, MakesTheSimulatedDeviceFromItsValues) {
  const SampledPath path = wavyPath();
  for (unsigned seed = 0; seed < 200; ++seed) {
    Seeded random(seed);
    SimulatedDeviceParameters wanted;
    DeviceSetup setup{.path = &path, .rate_hz = random.between(100, 4000)};
    const auto draw = [&](const char* key, double& member, double low, double high) {
      if (random.pick(4) == 0) return;
      member = random.between(low, high);
      setup.values[key] = member;
    };
    if (random.pick(4) != 0) setup.values["spring_hand"] = 1;
    wanted.hand = setup.values.empty() ? Hand::kRigid : Hand::kSpring;
    draw("hand_mass_kg", wanted.dynamics.hand_mass_kg, 0, 1);
    draw("hand_damping_Ns_per_m", wanted.dynamics.hand_damping_Ns_per_m, 0, 10);
    draw("hand_stiffness_N_per_m", wanted.dynamics.hand_stiffness_N_per_m, 0, 1000);
    draw("mass_kg", wanted.dynamics.device_mass_kg, 0.01, 1);
    draw("damping_Ns_per_m", wanted.dynamics.device_damping_Ns_per_m, 0, 3);
    draw("force_limit_N", wanted.force_limit_N, 0.5, 12);
    draw("encoder_resolution_m", wanted.encoder_resolution_m, 0, 1e-4);
    double delay = wanted.delay_ticks;
    draw("delay_ticks", delay, 0, 20);
    wanted.delay_ticks = static_cast<int>(delay);
    SimulatedDevice by_type(wanted, path, setup.rate_hz);
    const std::unique_ptr<Device> by_name = makeDevice("simulated", setup);
    EXPECT_EQ(by_name->name(), by_type.name());
    ASSERT_EQ(felt(*by_name), felt(by_type)) << seed;
  }
}

TEST(DeviceRegistry, HasUsualValuesWithinTheirRanges) {
  EXPECT_EQ(devices().front().name, "simulated");
  for (const DeviceEntry& entry : devices()) {
    EXPECT_FALSE(entry.description.empty());
    EXPECT_EQ(&deviceEntry(entry.name), &entry);
    for (const DeviceParameter& p : entry.parameters()) {
      EXPECT_LE(p.lowest, p.usual) << p.key;
      EXPECT_GE(p.highest, p.usual) << p.key;
      EXPECT_LT(p.lowest, p.highest) << p.key;
      EXPECT_FALSE(p.help.empty()) << p.key;
      EXPECT_EQ(&deviceParameter(entry.name, p.key), &p);
    }
  }
  EXPECT_EQ(deviceParameter("simulated", "hand_mass_kg").usual, HandParameters{}.hand_mass_kg);
  EXPECT_THROW(static_cast<void>(deviceParameter("simulated", "colour")), std::logic_error);
}

// In SI units: what scenes and the command line may give.
TEST(DeviceRegistry, TheSimulatedDeviceTakesTheseValues) {
  std::vector<std::string> rows;
  for (const DeviceParameter& p : deviceEntry("simulated").parameters())
    rows.push_back(fmt::format("{} [{}] {:g} to {:g}, usually {:g}", p.key, p.unit, p.lowest, p.highest, p.usual));
  EXPECT_THAT(rows,
              testing::ElementsAre(
                  "spring_hand [] 0 to 1, usually 0", "hand_mass_kg [kg] 0 to 100, usually 0.1",
                  "hand_damping_Ns_per_m [N s/m] 0 to 10000, usually 3",
                  "hand_stiffness_N_per_m [N/m] 0 to 100000, usually 400", "mass_kg [kg] 1e-06 to 100, usually 0.05",
                  "damping_Ns_per_m [N s/m] 0 to 10000, usually 0.1", "force_limit_N [N] 0 to 1000, usually 8",
                  "encoder_resolution_m [m] 0 to 0.01, usually 0", "friction_N [N] 0 to 100, usually 0",
                  "dropped_share [] 0 to 0.99, usually 0", "delay_ticks [ticks] 0 to 1000, usually 0"));
}

TEST(DeviceRegistry, ASpringHandIsAskedForByANumber) {
  const SampledPath path = wavyPath();
  for (const double asked : {0.0, 1.0}) {
    const auto device = makeDevice("simulated", {.path = &path, .values = {{"spring_hand", asked}}});
    EXPECT_EQ(device->name(), asked > 0 ? "simulated, spring hand" : "simulated, rigid hand");
  }
}

TEST(DeviceRegistry, RefusesWhatItDoesNotHave) {
  const SampledPath path = wavyPath();
  const auto refusal = [&](const char* name, const DeviceSetup& setup) {
    return refusalOf([&] { static_cast<void>(makeDevice(name, setup)); });
  };
  EXPECT_THAT(refusal("simulate", {.path = &path}), HasSubstr("did you mean simulated?"));
  EXPECT_THAT(refusal("simulated", {}), HasSubstr("no path to lead it along"));
  EXPECT_THAT(refusal("simulated", {.path = &path, .values = {{"colour", 1}}}), HasSubstr("no such parameter"));
  for (const DeviceParameter& p : deviceEntry("simulated").parameters()) {
    for (const double bad : {p.lowest - 1, p.highest * 1.001, std::nan("")}) {
      const std::string words = refusal("simulated", {.path = &path, .values = {{std::string(p.key), bad}}});
      EXPECT_THAT(words, HasSubstr(std::string(p.key) + " of device simulated: ")) << bad;
      EXPECT_THAT(words, HasSubstr("out of range")) << bad;
    }
    if (p.key == "force_limit_N") continue;  // the device itself refuses 0
    for (const double good : {p.lowest, p.highest})
      EXPECT_EQ(refusal("simulated", {.path = &path, .values = {{std::string(p.key), good}}}), kNoRefusal) << p.key;
  }
}

}  // namespace registry_test
}  // namespace palpate
