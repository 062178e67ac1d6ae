// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/brush_holders.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace palpate {
namespace brush_holders_test {

struct Windows : testing::Test {
  BrushHolders holders;
  std::shared_ptr<BrushHand> one = std::make_shared<BrushHand>(), other = std::make_shared<BrushHand>();
  int taken = 0, dropped = 0;
  void hold(const std::shared_ptr<BrushHand>& hand, BrushHolders::Turn turn) {
    holders.hold(hand, turn, [this] { ++taken; });
  }
  void release(const std::shared_ptr<BrushHand>& hand) {
    holders.release(hand, [this] { ++dropped; });
  }
};

TEST_F(Windows, HoldAndRelease) {
  for (int i = 1; i < 4; ++i) {
    hold(one, holders.ask(*one));
    EXPECT_EQ(taken, i);
    release(one);
    EXPECT_EQ(dropped, i);
    release(one);
    EXPECT_EQ(dropped, i) << "nothing is held";
  }
}

// The question waits for a mesh, say, and the button is let go of meanwhile, or the window goes.
TEST_F(Windows, AReleaseIsNotOvertaken) {
  const BrushHolders::Turn turn = holders.ask(*one);
  release(one);
  hold(one, turn);
  EXPECT_EQ(taken, 0);
  hold(one, holders.ask(*one));
  EXPECT_EQ(taken, 1);
}

TEST_F(Windows, TheNewestHolds) {
  hold(one, holders.ask(*one));
  hold(other, holders.ask(*other));
  release(one);
  EXPECT_EQ(dropped, 0);
  release(other);
  EXPECT_EQ(dropped, 1);
}

TEST_F(Windows, WhatCannotBeTakenIsNotHeld) {
  hold(one, holders.ask(*one));
  EXPECT_THROW(holders.hold(other, holders.ask(*other), [] { throw std::runtime_error("no room"); }),
               std::runtime_error);
  release(other);
  EXPECT_EQ(dropped, 0);
  release(one);
  EXPECT_EQ(dropped, 1);
}

}  // namespace brush_holders_test
}  // namespace palpate
