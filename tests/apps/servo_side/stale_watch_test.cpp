// SPDX-License-Identifier: Apache-2.0
#include "apps/servo_side/stale_watch.hpp"

#include <random>

#include <gmock/gmock.h>

namespace palpate {
namespace stale_watch_test {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kStart_ns = 7'000'000'000, kLast_ns = StaleWatch::kLasting_ns;

TEST(StaleWatch, TellsOnceWhatLastsAndOnceThatItIsOver) {
  StaleWatch watch;
  EXPECT_THAT(watch.look(false, 0), IsEmpty());
  EXPECT_THAT(watch.look(true, kStart_ns), IsEmpty());
  EXPECT_THAT(watch.look(true, kStart_ns + kLast_ns - 1), IsEmpty());
  EXPECT_THAT(watch.look(true, kStart_ns + kLast_ns), HasSubstr("sends no windows"));
  EXPECT_THAT(watch.look(true, kStart_ns + 2 * kLast_ns), IsEmpty());
  EXPECT_THAT(watch.look(false, kStart_ns + 3 * kLast_ns), HasSubstr("windows again; they were stale for 1.5 s"));
  EXPECT_THAT(watch.look(false, kStart_ns + 4 * kLast_ns), IsEmpty());
}

TEST(StaleWatch, ASecondTimeCountsFromItsOwnBeginning) {
  StaleWatch watch;
  for (int time = 0; time < 3; ++time) {
    const std::int64_t from_ns = kStart_ns + time * StaleWatch::kPause_ns;
    EXPECT_THAT(watch.look(true, from_ns), IsEmpty());
    EXPECT_THAT(watch.look(true, from_ns + kLast_ns), HasSubstr("sends no windows"));
    EXPECT_THAT(watch.look(false, from_ns + kLast_ns), HasSubstr("stale for 0.5 s"));
  }
}

// An engine that comes and goes fills no log.
TEST(StaleWatch, TellsOfTheNextOneAfterAPause) {
  StaleWatch watch;
  int told = 0;
  constexpr int kTimes = 100;
  for (int time = 0; time < kTimes; ++time) {
    for (const std::int64_t at_ns : {std::int64_t{0}, kLast_ns, 2 * kLast_ns})
      told += watch.look(at_ns < 2 * kLast_ns, time * 2 * kLast_ns + at_ns).empty() ? 0 : 1;
  }
  // Each lasts for a second, so it is told of in every tenth: its beginning and its end.
  EXPECT_EQ(told, 2 * kTimes * 2 * kLast_ns / StaleWatch::kPause_ns);
}

TEST(StaleWatch, WhatBeginsInThePauseIsToldIfItOutlastsIt) {
  StaleWatch watch;
  EXPECT_THAT(watch.look(true, 0), IsEmpty());
  EXPECT_THAT(watch.look(true, kLast_ns), HasSubstr("sends no windows"));
  EXPECT_THAT(watch.look(false, kLast_ns + 1), HasSubstr("again"));
  EXPECT_THAT(watch.look(true, kLast_ns + 2), IsEmpty());
  EXPECT_THAT(watch.look(true, kLast_ns + StaleWatch::kPause_ns - 1), IsEmpty());
  EXPECT_THAT(watch.look(true, kLast_ns + StaleWatch::kPause_ns), HasSubstr("sends no windows"));
}

// The engine broke off and came back: the end of what was told is told, and what was not told does not count on.
TEST(StaleWatch, GoesOnWithTheNextEngine) {
  StaleWatch watch;
  EXPECT_THAT(watch.look(true, 0), IsEmpty());
  watch.beginAnew();
  EXPECT_THAT(watch.look(true, kLast_ns), IsEmpty());
  EXPECT_THAT(watch.look(true, 2 * kLast_ns), HasSubstr("sends no windows"));
  watch.beginAnew();
  EXPECT_THAT(watch.look(true, 3 * kLast_ns), IsEmpty());
  EXPECT_THAT(watch.look(false, 4 * kLast_ns), HasSubstr("stale for 1.5 s"));
  EXPECT_THAT(watch.look(true, 5 * kLast_ns), IsEmpty());
  EXPECT_THAT(watch.look(true, 6 * kLast_ns), IsEmpty()) << "the pause goes on, too";
}

// A driver without a GPU is late for a moment again and again.
TEST(StaleWatch, SaysNothingOfMoments) {
  StaleWatch watch;
  std::mt19937 random(1);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_THAT(watch.look(true, now_ns), IsEmpty());
    now_ns += std::uniform_int_distribution<std::int64_t>(0, kLast_ns - 1)(random);
    EXPECT_THAT(watch.look(true, now_ns), IsEmpty());
    EXPECT_THAT(watch.look(false, ++now_ns), IsEmpty());
  }
}

}  // namespace stale_watch_test
}  // namespace palpate
