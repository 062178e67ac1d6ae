// SPDX-License-Identifier: Apache-2.0
#include "servo/loop/live_ticks.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace palpate {
namespace live_ticks_test {

TEST(LiveTicks, GivesEveryTickOnceAndTheNewestAlways) {
  LiveTicks live(4);
  EXPECT_EQ(live.latest().tick, -1);
  std::vector<TickRecord> seen;
  live.take(seen);
  EXPECT_TRUE(seen.empty());
  for (int round = 0; round < 5; ++round) {
    for (int i = 0; i < 3; ++i) live.add({.tick = 3 * round + i});
    EXPECT_EQ(live.latest().tick, 3 * round + 2);
    live.take(seen);
  }
  ASSERT_EQ(seen.size(), 15U);
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i].tick, static_cast<std::int64_t>(i));
}

// The oldest stay, so that what the reader has is without a gap up to there; the newest is known all the same.
TEST(LiveTicks, LeavesOutWhatHasNoRoom) {
  LiveTicks live(4);
  for (int i = 0; i < 10; ++i) live.add({.tick = i});
  std::vector<TickRecord> seen;
  live.take(seen);
  ASSERT_EQ(seen.size(), 4U);
  EXPECT_EQ(seen.back().tick, 3);
  EXPECT_EQ(live.latest().tick, 9);
  live.add({.tick = 10});
  live.take(seen);
  ASSERT_EQ(seen.size(), 5U);
  EXPECT_EQ(seen.back().tick, 10);
}

// A record is never seen half written: all of its numbers are of one tick.
TEST(LiveTicks, AreWholeWhileAnotherThreadLooks) {
  constexpr std::int64_t kTicks = 200'000;
  LiveTicks live(256);
  std::thread servo([&] {
    for (std::int64_t i = 0; i < kTicks; ++i)
      live.add({.tick = i, .time_s = static_cast<double>(i), .energy_J = static_cast<double>(i)});
  });
  std::vector<TickRecord> seen;
  std::int64_t newest = -1, listed = -1;
  while (newest < kTicks - 1) {
    const TickRecord& latest = live.latest();
    if (latest.tick >= 0) {
      ASSERT_EQ(latest.energy_J, static_cast<double>(latest.tick));
      ASSERT_GE(latest.tick, newest);
      newest = latest.tick;
    }
    seen.clear();
    live.take(seen);
    for (const TickRecord& r : seen) {
      ASSERT_EQ(r.time_s, static_cast<double>(r.tick));
      ASSERT_GT(r.tick, listed);
      listed = r.tick;
    }
  }
  servo.join();
}

}  // namespace live_ticks_test
}  // namespace palpate
