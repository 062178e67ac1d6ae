// SPDX-License-Identifier: Apache-2.0
#include "apps/sculpt/key_pointer.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace key_pointer_test {

constexpr double kWidth = 800, kHeight = 600, kFrame_s = 0.02;
// In a frame: of the pointer, and of a turn [pixel].
constexpr double kStep = 0.25 * kFrame_s * kHeight, kTurned = 0.5 * kFrame_s * kHeight;

class Keys : public testing::Test {
 protected:
  PointerInput take(const PointerKeys& keys, PointerInput input = {}) {
    pointer.take(keys, kFrame_s, kWidth, kHeight, input);
    return input;
  }
  static PointerInput mouseAt(double x, double y) {
    PointerInput input;
    input.x = x;
    input.y = y;
    input.over = true;
    return input;
  }
  KeyPointer pointer;
};

TEST_F(Keys, LeaveTheMouseAloneWhileNoneIsHeld) {
  const PointerInput input = take({}, mouseAt(10, 20));
  EXPECT_EQ(input.x, 10);
  EXPECT_EQ(input.y, 20);
  EXPECT_FALSE(input.left);
  EXPECT_FALSE(pointer.leads());
}

TEST_F(Keys, MoveThePointerFromWhereTheMouseLeftIt) {
  PointerInput input = take({.right = true}, mouseAt(100, 200));
  EXPECT_TRUE(pointer.leads());
  EXPECT_NEAR(input.x, 100 + kStep, 1e-12);
  EXPECT_EQ(input.y, 200);
  EXPECT_TRUE(input.over);
  EXPECT_FALSE(input.left);
  EXPECT_FALSE(input.middle);
  input = take({.left = true, .up = true}, mouseAt(700, 3));  // the resting mouse counts no more
  EXPECT_NEAR(input.x, 100, 1e-12);
  EXPECT_NEAR(input.y, 200 - kStep, 1e-12);
  input = take({.down = true});
  EXPECT_NEAR(input.y, 200, 1e-12);
  input = take({});  // it stays where it is
  EXPECT_NEAR(input.x, 100, 1e-12);
  EXPECT_TRUE(pointer.leads());
  input = take({.left = true, .right = true, .up = true, .down = true});
  EXPECT_NEAR(input.x, 100, 1e-12);
  EXPECT_NEAR(input.y, 200, 1e-12);
}

TEST_F(Keys, BeginInTheMiddleWhereTheMouseIsElsewhere) {
  PointerInput outside = mouseAt(5000, -3);
  outside.over = false;
  const PointerInput input = take({.press = true}, outside);
  EXPECT_EQ(input.x, kWidth / 2);
  EXPECT_EQ(input.y, kHeight / 2);
  EXPECT_TRUE(input.over);
  EXPECT_TRUE(input.left);
}

TEST_F(Keys, StayInThePicture) {
  for (int i = 0; i < 1000; ++i) take({.left = true, .up = true});
  PointerInput input = take({});
  EXPECT_EQ(input.x, 0);
  EXPECT_EQ(input.y, 0);
  for (int i = 0; i < 1000; ++i) input = take({.right = true, .down = true});
  EXPECT_EQ(input.x, kWidth - 1);
  EXPECT_EQ(input.y, kHeight - 1);
}

TEST_F(Keys, PressWhileTheyMove) {
  PointerInput with_ctrl = mouseAt(100, 100);
  with_ctrl.ctrl = with_ctrl.shift = true;
  const PointerInput input = take({.right = true, .press = true}, with_ctrl);
  EXPECT_TRUE(input.left);
  EXPECT_FALSE(input.middle);
  EXPECT_TRUE(input.ctrl);  // the opposite brush
  EXPECT_TRUE(input.shift);
  EXPECT_NEAR(input.x, 100 + kStep, 1e-12);
}

// Ctrl and arrows are the middle button and a movement; Shift says that it moves the object.
TEST_F(Keys, TurnTheObjectWithCtrl) {
  PointerInput held = mouseAt(100, 100);
  held.ctrl = true;
  PointerInput input = take({.left = true, .down = true}, held);
  EXPECT_TRUE(input.middle);
  EXPECT_FALSE(input.ctrl);
  EXPECT_FALSE(input.shift);
  EXPECT_NEAR(input.dx, -kTurned, 1e-12);
  EXPECT_NEAR(input.dy, kTurned, 1e-12);
  EXPECT_EQ(input.x, 100);
  EXPECT_EQ(input.y, 100);
  held.shift = true;
  EXPECT_TRUE(take({.up = true}, held).shift);
  input = take({}, held);
  EXPECT_FALSE(input.middle);
}

TEST_F(Keys, AreAWheelToo) {
  EXPECT_EQ(take({.wheel = -1}).wheel, -1);
  EXPECT_TRUE(pointer.leads());
}

TEST_F(Keys, GiveWayToTheMouse) {
  for (const int way : {0, 1, 2, 3, 4, 5}) {
    take({.right = true}, mouseAt(100, 100));
    ASSERT_TRUE(pointer.leads());
    PointerInput mouse = mouseAt(300, 400);
    mouse.dx = way == 0 ? 1 : 0;
    mouse.dy = way == 1 ? -1 : 0;
    mouse.left = way == 2;
    mouse.middle = way == 3;
    mouse.right = way == 4;
    mouse.wheel = way == 5 ? 1 : 0;
    const PointerInput input = take({.left = true}, mouse);
    EXPECT_FALSE(pointer.leads()) << way;
    EXPECT_EQ(input.x, 300);
    EXPECT_EQ(input.left, way == 2);
  }
}

// A bumped mouse ends what Space pressed; it begins again only once Space is pressed anew.
TEST_F(Keys, ThatAreHeldWhileTheMouseMovesBeginNothing) {
  EXPECT_TRUE(take({.press = true}, mouseAt(100, 100)).left);
  PointerInput mouse = mouseAt(300, 400);
  mouse.dx = 1;
  EXPECT_FALSE(take({.press = true}, mouse).left);
  EXPECT_FALSE(take({.press = true}, mouseAt(300, 400)).left);
  EXPECT_FALSE(take({.right = true, .press = true}, mouseAt(300, 400)).left);
  take({}, mouseAt(300, 400));
  EXPECT_TRUE(take({.press = true}, mouseAt(300, 400)).left);
}

// While a brush's size or strength is chosen, its movement counts.
TEST_F(Keys, MoveByAsMuchAsTheySay) {
  const PointerInput input = take({.right = true, .up = true}, mouseAt(100, 100));
  EXPECT_NEAR(input.dx, kStep, 1e-12);
  EXPECT_NEAR(input.dy, -kStep, 1e-12);
}

// A frame that took long, behind a dialogue for example, does not throw the pointer across the picture.
TEST_F(Keys, ALongFrameIsATenthOfASecond) {
  PointerInput input = mouseAt(100, 100);
  pointer.take({.right = true}, 5, kWidth, kHeight, input);
  EXPECT_NEAR(input.x, 100 + 0.1 * 0.25 * kHeight, 1e-12);
}

TEST_F(Keys, AnyIsAnyOfThem) {
  EXPECT_FALSE(PointerKeys{}.any());
  EXPECT_TRUE(PointerKeys{.left = true}.any());
  EXPECT_TRUE(PointerKeys{.right = true}.any());
  EXPECT_TRUE(PointerKeys{.up = true}.any());
  EXPECT_TRUE(PointerKeys{.down = true}.any());
  EXPECT_TRUE(PointerKeys{.press = true}.any());
  EXPECT_TRUE(PointerKeys{.wheel = 1}.any());
}

}  // namespace key_pointer_test
}  // namespace palpate
