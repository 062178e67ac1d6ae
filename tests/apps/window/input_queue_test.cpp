// SPDX-License-Identifier: Apache-2.0
#include "apps/window/input_queue.hpp"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace input_queue_test {

using Kind = InputEvent::Kind;

InputEvent move(double x, double y) {
  return {.kind = Kind::kMove, .x = x, .y = y};
}
InputEvent button(int code, bool down) {
  return {.kind = Kind::kButton, .code = code, .down = down};
}
InputEvent key(int code, bool down) {
  return {.kind = Kind::kKey, .code = code, .down = down};
}

TEST(InputQueue, AKeyThatGoesDownAndUpIsSeen) {
  InputQueue queue;
  queue.add(key(65, true));
  queue.add(key(65, false));
  queue.add(key(65, true));
  EXPECT_TRUE(queue.nextFrame().keys[65]);
  EXPECT_FALSE(queue.nextFrame().keys[65]);
  EXPECT_TRUE(queue.nextFrame().keys[65]);
  EXPECT_TRUE(queue.empty());
  EXPECT_TRUE(queue.nextFrame().keys[65]);  // still held
}

TEST(InputQueue, DifferentKeysChangeTogether) {
  InputQueue queue;
  for (const int code : {341, 90}) queue.add(key(code, true));
  const InputState& state = queue.nextFrame();
  EXPECT_TRUE(state.keys[341] && state.keys[90]);
}

// Ctrl went down a frame before; it is still held in the frame in which the other key counts, and in that of a click.
TEST(InputQueue, WhatIsHeldIsHeldUntilWhatWasPressedHasBeenSeen) {
  InputQueue queue;
  queue.add(key(341, true));
  queue.nextFrame();
  queue.add(key(90, true));
  queue.add(key(341, false));
  queue.add(key(90, false));
  InputState state = queue.nextFrame();
  EXPECT_TRUE(state.keys[90] && state.keys[341]);
  state = queue.nextFrame();
  EXPECT_FALSE(state.keys[90] || state.keys[341]);  // both are let go at once
  queue.add(key(341, true));
  queue.nextFrame();
  queue.add(button(0, true));
  queue.add(key(341, false));
  queue.add(key(340, true));
  state = queue.nextFrame();
  EXPECT_TRUE(state.buttons[0] && state.keys[341]);
  EXPECT_FALSE(state.keys[340]);
  state = queue.nextFrame();
  EXPECT_FALSE(state.keys[341]);
  EXPECT_TRUE(state.keys[340]);
  EXPECT_TRUE(queue.empty());
}

// A click is made where the pointer was, though it has moved on since.
TEST(InputQueue, AClickIsWhereItWasMade) {
  InputQueue queue;
  queue.add(move(1, 1));
  queue.add(move(10, 20));
  queue.add(button(0, true));
  queue.add(move(30, 40));
  queue.add(button(0, false));
  InputState state = queue.nextFrame();
  EXPECT_EQ(state.x, 10);
  EXPECT_EQ(state.y, 20);
  EXPECT_TRUE(state.buttons[0]);
  state = queue.nextFrame();
  EXPECT_EQ(state.x, 30);
  EXPECT_FALSE(state.buttons[0]);
  EXPECT_TRUE(queue.empty());
}

TEST(InputQueue, WheelAndTextBelongToOneFrame) {
  InputQueue queue;
  queue.add({.kind = Kind::kWheel, .x = 1, .y = 2});
  queue.add({.kind = Kind::kWheel, .x = 1, .y = -5});
  queue.add({.kind = Kind::kText, .character = 'a'});
  queue.add({.kind = Kind::kText, .character = 0x20AC});
  InputState state = queue.nextFrame();
  EXPECT_EQ(state.wheel_x, 2);
  EXPECT_EQ(state.wheel_y, -3);
  EXPECT_THAT(state.text, testing::ElementsAre('a', 0x20AC));
  state = queue.nextFrame();
  EXPECT_EQ(state.wheel_x, 0);
  EXPECT_EQ(state.wheel_y, 0);
  EXPECT_TRUE(state.text.empty());
}

TEST(InputQueue, LosingTheFocusLetsEverythingGo) {
  InputQueue queue;
  queue.add(key(65, true));
  queue.add(button(1, true));
  queue.nextFrame();
  queue.add({.kind = Kind::kFocusLost});
  const InputState& state = queue.nextFrame();
  EXPECT_FALSE(state.keys[65]);
  EXPECT_FALSE(state.buttons[1]);
}

TEST(InputQueue, IgnoresKeysAndButtonsThatItDoesNotKnow) {
  InputQueue queue;
  for (const int code : {-1, 512, 100000}) queue.add(key(code, true));
  for (const int code : {-1, 5}) queue.add(button(code, true));
  const InputState& state = queue.nextFrame();
  EXPECT_TRUE(queue.empty());
  EXPECT_THAT(state.keys, testing::Each(false));
  EXPECT_THAT(state.buttons, testing::Each(false));
}

// Random events: every change of a key is in a frame of its own, in its order, and all arrive.
TEST(InputQueue, LosesNothing) {
  std::mt19937 random(11);
  InputQueue queue;
  std::vector<bool> wanted[4];
  bool now[4] = {};
  for (int i = 0; i < 2000; ++i) {
    const auto code = static_cast<int>(random() % 4);
    if (random() % 3 == 0) {
      queue.add(move(i, -i));
    } else {
      now[code] = !now[code];
      queue.add(code < 2 ? key(code, now[code]) : button(code, now[code]));
      wanted[code].push_back(now[code]);
    }
  }
  std::vector<bool> seen[4];
  bool last[4] = {};
  while (!queue.empty()) {
    const InputState& state = queue.nextFrame();
    for (int code = 0; code < 4; ++code) {
      const bool down = code < 2 ? state.keys[code] : state.buttons[code];
      if (down != last[code]) seen[code].push_back(down);
      last[code] = down;
    }
  }
  for (int code = 0; code < 4; ++code) EXPECT_EQ(seen[code], wanted[code]) << code;
}

}  // namespace input_queue_test
}  // namespace palpate
