// SPDX-License-Identifier: Apache-2.0
#include "servo/safety/window_clock.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace palpate {
namespace window_clock_test {

constexpr std::int64_t kTolerance_ns = 10'000'000;
constexpr std::uint32_t kStep = bit(ServoFault::kClockStep);

class WindowClockTest : public testing::Test {
 protected:
  void expect(const WindowClock::Reading& reading, std::int64_t age_ns, std::uint32_t faults) {
    EXPECT_EQ(reading.age_ns, age_ns);
    EXPECT_EQ(reading.faults, faults);
  }
  WindowClock clock{kTolerance_ns};
};

TEST_F(WindowClockTest, AgeIsTimeSinceTheLastConfirmation) {
  expect(clock.read(1000, 900, 1, 500), 100, 0);
  expect(clock.read(2000, 900, 1, 500), 1100, 0);
  expect(clock.read(3000, 2500, 1, 500), 500, 0);
}

TEST_F(WindowClockTest, NoWindowHasNoAge) {
  expect(clock.read(5'000'000'000, 0, 0, 0), 0, 0);
}

// The servo looked at the confirmation (none yet), then the engine published: the window is as old as its stamp, in
// this tick and, if the engine is slow to confirm, in the next.
TEST_F(WindowClockTest, AWindowPublishedBetweenTheTwoLooksIsFresh) {
  const std::int64_t start_ns = 5'000'000'000;  // long after the clock's zero
  expect(clock.read(start_ns, 0, 0, 0), 0, 0);
  expect(clock.read(start_ns + 1000, 0, 1, start_ns + 700), 300, 0);
  expect(clock.read(start_ns + 2000, 0, 1, start_ns + 700), 1300, 0);
  expect(clock.read(start_ns + 3000, start_ns + 700, 1, start_ns + 700), 2300, 0);
}

TEST_F(WindowClockTest, AServoClockThatGoesBackIsSeenInItsTick) {
  expect(clock.read(2000, 1900, 1, 0), 100, 0);
  expect(clock.read(1950, 1900, 1, 0), 50, kStep);
  expect(clock.read(1960, 1950, 1, 0), 10, 0);
  expect(clock.read(1960, 1950, 1, 0), 10, 0);  // the same time again is none
}

// Seen in its tick; afterwards the window looks older than it is, which is safe.
TEST_F(WindowClockTest, AConfirmationThatGoesBackIsSeenInItsTick) {
  expect(clock.read(2000, 1900, 1, 0), 100, 0);
  expect(clock.read(3000, 1500, 1, 0), 1500, kStep);
  expect(clock.read(4000, 2500, 1, 0), 1500, 0);
}

TEST_F(WindowClockTest, AConfirmationInTheFutureIsAFaultUntilTimeCatchesUp) {
  const std::int64_t ahead_ns = 50'000'000;
  expect(clock.read(0, ahead_ns, 1, 0), 0, kStep);
  expect(clock.read(ahead_ns - kTolerance_ns - 1, ahead_ns, 1, 0), 0, kStep);
  // Within the tolerance the servo may have been preempted between its two looks.
  expect(clock.read(ahead_ns - kTolerance_ns, ahead_ns, 1, 0), 0, 0);
  expect(clock.read(ahead_ns + 1, ahead_ns, 1, 0), 1, 0);
}

TEST_F(WindowClockTest, TimesThatNoSubtractionHoldsAreAStep) {
  expect(clock.read(1000, std::numeric_limits<std::int64_t>::min() + 5, 1, std::numeric_limits<std::int64_t>::min()), 0,
         kStep);
  expect(clock.read(1001, std::numeric_limits<std::int64_t>::max(), 1, 0), 0, kStep);
}

}  // namespace window_clock_test
}  // namespace palpate
