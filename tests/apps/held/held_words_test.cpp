// SPDX-License-Identifier: Apache-2.0
#include "apps/held/held_words.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "servo/devices/force_off.hpp"

namespace palpate {
namespace held_words_test {

using testing::ElementsAre;
using testing::HasSubstr;

class Arm final : public Device {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "arm"; }
  [[nodiscard]] DeviceLimits limits() const noexcept override {
    return {.motors_unchecked = unchecked, .stiffness_limit_N_per_m = most};
  }
  [[nodiscard]] ForceOff forceOff() const noexcept override { return off; }
  [[nodiscard]] bool read(Vec3&) noexcept override { return false; }
  [[nodiscard]] bool write(const Vec3&) noexcept override { return false; }
  ForceOff off = ForceOff::kNone;
  double most = 800;
  bool unchecked = false;
};

TEST(HeldWords, ScaleAndTheWallAtTheHandle) {
  Placement placement;
  placement.scale = 2;
  placement.force_scale = 0.5;
  EXPECT_THAT(heldDeviceWords("arm-1", Arm(), placement, 400),
              ElementsAre("arm-1: 1 mm of the device moves the tool by 2 mm, 1 N of the scene is 0.5 N; a wall of 400 "
                          "N/m is one of 400 N/m at its handle"));
  placement.force_scale = 3;
  EXPECT_THAT(heldDeviceWords("arm-1", Arm(), placement, 400)[0], HasSubstr("one of 2400 N/m at its handle"));
}

TEST(HeldWords, WhatItsMakerAdvisesAgainst) {
  EXPECT_EQ(heldDeviceWords("arm", Arm(), {}, 800).size(), 1U);
  EXPECT_THAT(
      heldDeviceWords("arm", Arm(), {}, 801),
      ElementsAre(testing::_, HasSubstr("a stiffness of 801 N/m is more than the device's maker states: give at "
                                        "most 800 N/m")));
}

// What is advised can be given: it is not told again.
TEST(HeldWords, TheMakersLimitIsNotRoundedUp) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    Arm arm;
    arm.most = std::pow(10, std::uniform_real_distribution<>(-1, 6)(random));
    const std::string words = heldDeviceWords("arm", arm, {}, 1e7).at(1);
    const std::size_t at = words.find("at most ") + 8;
    const double advised = std::stod(words.substr(at));
    EXPECT_GT(advised, 0.998 * arm.most);
    EXPECT_EQ(heldDeviceWords("arm", arm, {}, advised).size(), 1U) << words << ", " << arm.most;
  }
}

// Each reason that a device has for no force is told with what to do.
TEST(HeldWords, WhyThereIsNoForce) {
  for (const ForceOff why : {ForceOff::kInputOnly, ForceOff::kNoCurrentLimit, ForceOff::kUncalibrated,
                             ForceOff::kLimitZero, ForceOff::kDisconnected}) {
    Arm arm;
    arm.off = why;
    const std::vector<std::string> words = heldDeviceWords("arm", arm, {}, 400);
    ASSERT_EQ(words.size(), 2U);
    EXPECT_THAT(words[1], HasSubstr("forces are off because " + std::string(wordsOf(why).reason)));
    EXPECT_THAT(words[1], HasSubstr(std::string(wordsOf(why).remedy)));
  }
}

// The run says it as the doctor does.
TEST(HeldWords, ThatNobodyHasCheckedItsMotors) {
  Arm arm;
  arm.unchecked = true;
  const UncheckedWords unchecked = uncheckedWords("arm-1");
  EXPECT_THAT(unchecked.reason, HasSubstr("forces stay below 1 N"));
  EXPECT_THAT(unchecked.remedy, HasSubstr("palpate calibrate --device arm-1 --check"));
  EXPECT_THAT(heldDeviceWords("arm-1", arm, {}, 400),
              ElementsAre(testing::_, unchecked.reason + "; " + unchecked.remedy));
}

}  // namespace held_words_test
}  // namespace palpate
