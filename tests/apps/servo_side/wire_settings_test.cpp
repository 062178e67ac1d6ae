// SPDX-License-Identifier: Apache-2.0
// What goes to another process comes out there as it was, to the bit.
#include "apps/servo_side/wire_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/any_settings.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace wire_settings_test {

using testing::HasSubstr;

// Through the bytes of a message.
RigSettings sent(const RigSettings& settings) {
  wire::ChangeT change;
  change.settings = wireOf(settings);
  wire::BodyUnion body = decoded(encoded(std::move(change)), "test");
  return settingsOf(contentOf<wire::ChangeT>(body)->settings);
}

TEST(WireSettings, ComeOutAsTheyWere) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Seeded random(seed);
    const RigSettings settings = anySettings(random);
    EXPECT_EQ(sent(settings), settings) << seed;
  }
}

TEST(WireSettings, RefuseWhatIsNone) {
  const auto refusal = [](const std::function<void(wire::SettingsT&)>& spoil) {
    RigSettings settings;
    settings.haptization.density = {{1, 2, 3}};
    settings.haptization.gradient = {{1, 2}};
    settings.effects.stiffness_by_density = {{1, 2}};
    auto wire = wireOf(settings);
    spoil(*wire);
    return refusalOf([&] { static_cast<void>(settingsOf(wire)); });
  };
  EXPECT_EQ(refusal([](wire::SettingsT&) {}), kNoRefusal);
  EXPECT_THAT(refusal([](wire::SettingsT& s) { s.haptization_density[0]->values.pop_back(); }),
              HasSubstr("has not 3 values"));
  EXPECT_THAT(refusal([](wire::SettingsT& s) { s.haptization_gradient[0]->values.push_back(1); }),
              HasSubstr("has not 2 values"));
  EXPECT_THAT(refusal([](wire::SettingsT& s) { s.stiffness_density[0].reset(); }), HasSubstr("has not 2 values"));
  EXPECT_THAT(refusal([](wire::SettingsT& s) { s.texture = 3; }), HasSubstr("texture 3"));
  EXPECT_THAT(refusalOf([] { static_cast<void>(settingsOf(nullptr)); }), HasSubstr("a message has none"));
}

class Anything final : public Device {
 public:
  explicit Anything(Seeded& random) {
    of = {random.between(0, 9),
          random.pick(2) == 0,
          random.between(0, 9),
          random.pick(9),
          random.between(0, 9),
          random.pick(2) == 0,
          random.pick(2) == 0,
          random.between(0, 9),
          random.between(0, 9),
          random.pick(2) == 0,
          {random.between(0, 9), random.between(0, 9)}};
    for (int i = random.pick(4); i > 0; --i)
      all.push_back({random.between(0, 9), random.between(0, 9), random.between(0, 9), random.between(0, 9),
                     random.between(0, 9), random.between(0, 9)});
    off = static_cast<ForceOff>(random.pick(7));
  }
  [[nodiscard]] std::string_view name() const noexcept override { return "anything"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override { return of; }
  [[nodiscard]] std::vector<HandParameters> hands() const override { return all; }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return off; }
  [[nodiscard]] bool read(Vec3&) noexcept override { return false; }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
  DeviceLimits of;
  std::vector<HandParameters> all;
  ForceOff off = ForceOff::kNone;
};

TEST(WireSettings, KnowADeviceOverThere) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Seeded random(seed);
    const Anything device(random);
    wire::BodyUnion body = decoded(encoded(wireOf(device)), "test");
    const auto& made = *contentOf<wire::DeviceMadeT>(body);
    const DeviceLimits l = limitsOf(made);
    EXPECT_EQ(made.name, "anything");
    EXPECT_EQ(l.force_limit_N, device.of.force_limit_N);
    EXPECT_EQ(l.motors_unchecked, device.of.motors_unchecked);
    EXPECT_EQ(l.position_resolution_m, device.of.position_resolution_m);
    EXPECT_EQ(l.force_delay_ticks, device.of.force_delay_ticks);
    EXPECT_EQ(l.slew_limit_N_per_s, device.of.slew_limit_N_per_s);
    EXPECT_EQ(l.sets_pace, device.of.sets_pace);
    EXPECT_EQ(l.follows_force, device.of.follows_force);
    EXPECT_EQ(l.stiffness_limit_N_per_m, device.of.stiffness_limit_N_per_m);
    EXPECT_EQ(l.workspace_radius_m, device.of.workspace_radius_m);
    EXPECT_EQ(l.is_held, device.of.is_held);
    EXPECT_EQ(l.motion.speed_m_per_s, device.of.motion.speed_m_per_s);
    EXPECT_EQ(l.motion.acceleration_m_per_s2, device.of.motion.acceleration_m_per_s2);
    EXPECT_EQ(forceOffOf(made.force_off), device.off);
    const auto hands = handsOf(made);
    ASSERT_EQ(hands.size(), device.all.size());
    for (std::size_t i = 0; i < hands.size(); ++i) {
      for (double HandParameters::*const part :
           {&HandParameters::hand_mass_kg, &HandParameters::hand_damping_Ns_per_m,
            &HandParameters::hand_stiffness_N_per_m, &HandParameters::device_mass_kg,
            &HandParameters::device_damping_Ns_per_m, &HandParameters::device_friction_N})
        EXPECT_EQ(hands[i].*part, device.all[i].*part);
    }
  }
  EXPECT_EQ(forceOffOf(200), ForceOff::kDisconnected);
}

TEST(WireMessages, AVectorKeepsItsParts) {
  EXPECT_EQ(vectorOf(wireOf(Vec3(1, 2, 3))), Vec3(1, 2, 3));
  EXPECT_EQ(vectorOf(nullptr), Vec3(0, 0, 0));
}

TEST(WireMessages, AnErrorKeepsItsParts) {
  const Error error(Error::Code::kNotFound, "a", "b", "c");
  const Error back = errorOf(refusalMessage(error));
  EXPECT_EQ(back.code(), error.code());
  EXPECT_STREQ(back.what(), error.what());
  wire::RefusalT odd = refusalMessage(error);
  odd.code = 99;
  EXPECT_EQ(errorOf(odd).code(), Error::Code::kDevice);
}

// Bytes of a message, changed and cut at random: a message again, or refused; nothing else.
TEST(WireMessages, WhatIsNoneIsRefused) {
  Seeded random(1);
  wire::ChangeT change;
  change.settings = wireOf(anySettings(random));
  const std::vector<std::byte> bytes = encoded(std::move(change));
  int refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::byte> spoiled = bytes;
    for (int changes = 1 + random.pick(4); changes > 0; --changes)
      spoiled[static_cast<std::size_t>(random.pick(static_cast<int>(spoiled.size())))] =
          static_cast<std::byte>(random.pick(256));
    if (random.pick(3) == 0) spoiled.resize(static_cast<std::size_t>(random.pick(static_cast<int>(bytes.size()))));
    try {
      wire::BodyUnion body = decoded(spoiled, "test");
      if (auto* const again = contentOf<wire::ChangeT>(body); again != nullptr && again->settings)
        static_cast<void>(settingsOf(again->settings));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kBadInput);
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_THROW(static_cast<void>(decoded({}, "test")), Error);
}

}  // namespace wire_settings_test
}  // namespace palpate
