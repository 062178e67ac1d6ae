// SPDX-License-Identifier: Apache-2.0
// Sliders against the option table, which owns what they show.
#include "apps/sculpt/touch_sliders.hpp"

#include <gtest/gtest.h>

#include "apps/servo_setup/scene_settings.hpp"
#include "tests/servo/support/seeded.hpp"

namespace palpate {
namespace touch_sliders_test {

const NumberOption& numberOf(const TouchSlider& slider) {
  const SceneOption* const option = optionOfKey(slider.key);
  if (option == nullptr) throw std::runtime_error(slider.key);
  return std::get<NumberOption>(option->value);
}

// What a slider moves is its option and no other.
TEST(TouchSliders, MoveTheOptionThatTheyName) {
  for (const TouchSlider& slider : touchSliders()) {
    RigSettings moved;
    slider.of(moved) = 0.5 * (slider.low + slider.high) + 0.125 * slider.unit;
    const Scene before = withRigSettings({}, RigSettings{}), after = withRigSettings({}, moved);
    for (const SceneOption& option : sceneOptions())
      EXPECT_EQ(isSame(option.value, before, after), option.key != std::string_view(slider.key)) << option.key;
  }
}

TEST(TouchSliders, StayWithinTheOptionsRange) {
  for (const TouchSlider& slider : touchSliders()) {
    const NumberOption& number = numberOf(slider);
    EXPECT_LT(slider.low, slider.high) << slider.key;
    EXPECT_TRUE(number.takes(slider.low / number.scale)) << slider.key;
    EXPECT_TRUE(number.takes(slider.high / number.scale)) << slider.key;
  }
  const auto& renewal = std::get<IntegerOption>(optionOfKey("servo.n")->value);
  EXPECT_LE(renewal.lowest, 1);
  EXPECT_GE(renewal.highest, kMostRenewal_ticks);
}

// However they are moved, one after the other: the servo takes it, as no slider passes one that bounds it.
TEST(TouchSliders, AnyPlacesAreSettingsThatTheServoTakes) {
  Seeded random(3);
  RigSettings settings;
  for (int i = 0; i < 1000; ++i) {
    const TouchSlider& slider =
        touchSliders()[static_cast<std::size_t>(random.pick(static_cast<int>(touchSliders().size())))];
    const double low = slider.lowest(settings), high = slider.highest(settings);
    ASSERT_LE(low, high) << slider.key;
    slider.of(settings) = random.between(low, high);
    EXPECT_NO_THROW(static_cast<void>(
        makeContactEffects(settings.effects, settings.parameters.stiffness_N_per_m, settings.parameters.rate_hz)))
        << slider.key;
  }
}

}  // namespace touch_sliders_test
}  // namespace palpate
