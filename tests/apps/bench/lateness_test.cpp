// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/lateness.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace lateness_test {

using testing::HasSubstr;

TEST(LatenessCounts, QuantilesAreClassesThatWereSeen) {
  LatenessCounts counts;
  for (int us = 1; us <= 100; ++us) counts.add(us);
  EXPECT_EQ(counts.total(), 100);
  EXPECT_EQ(counts.quantile_us(0.5), 50);
  EXPECT_EQ(counts.quantile_us(0.99), 99);
  EXPECT_EQ(counts.quantile_us(1), 100);
  EXPECT_EQ(counts.quantile_us(0), 1);
}

TEST(LatenessCounts, AMissIsLaterThanAPeriod) {
  LatenessCounts counts;
  counts.add(999, 3);
  counts.add(1000, 2);
  counts.add(1001, 1);
  EXPECT_EQ(counts.misses(1000), 3);
  EXPECT_EQ(counts.misses(4000), 6);
  EXPECT_EQ(counts.misses(100), 0);
}

TEST(LatenessCounts, TooLateAndTooEarlyGoIntoTheLastClasses) {
  LatenessCounts counts;
  counts.add(-5);
  counts.add(10 * LatenessCounts::kOverflow_us);
  EXPECT_EQ(counts.quantile_us(0.5), 0);
  EXPECT_EQ(counts.quantile_us(1), LatenessCounts::kOverflow_us);
  EXPECT_EQ(counts.atLeast(1), 1);
}

TEST(LatenessCounts, AddUp) {
  LatenessCounts a, b;
  a.add(5, 2);
  b.add(7, 3);
  a.add(b);
  EXPECT_EQ(a.total(), 5);
  EXPECT_EQ(a.atLeast(6), 3);
}

TEST(LatenessCounts, OfNothingAreZero) {
  EXPECT_EQ(LatenessCounts{}.quantile_us(0.99), 0);
  EXPECT_EQ(LatenessCounts{}.misses(1000), 0);
}

// As rt-tests 2.4 prints it.
constexpr const char* kOutput =
    "# /dev/cpu_dma_latency set to 0us\n"
    "# Histogram\n"
    "000000 000000\n"
    "000001 000010\n"
    "000002 000985\n"
    "000040 000003\n"
    "# Total: 000000998\n"
    "# Min Latencies: 00001\n"
    "# Avg Latencies: 00002\n"
    "# Max Latencies: 120000\n"
    "# Histogram Overflows: 00002\n"
    "# Histogram Overflow at cycle number:\n"
    "# Thread 0: 00017 00400\n";

TEST(Cyclictest, HistogramIsReadWithItsOverflows) {
  const auto counts = parseCyclictest(kOutput);
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->total(), 1000);
  EXPECT_EQ(counts->quantile_us(0.5), 2);
  EXPECT_EQ(counts->quantile_us(0.997), 40);
  EXPECT_EQ(counts->quantile_us(1), LatenessCounts::kOverflow_us);
  EXPECT_EQ(counts->misses(1000), 2);
}

TEST(Cyclictest, OtherWordsAreNoHistogram) {
  EXPECT_FALSE(parseCyclictest(""));
  EXPECT_FALSE(parseCyclictest("Unable to change scheduling policy!\n"));
  EXPECT_FALSE(parseCyclictest("000001 garbage\n"));
}

// The same rate, priority, locking and clock as the servo's, and no more.
TEST(Cyclictest, IsAskedForWhatTheServoDoes) {
  const std::string command = cyclictestCommand({.rate_hz = 4000, .cycles = 8000, .priority = 80});
  for (const char* words : {"--interval=250", "--loops=8000", "--policy=fifo", "--priority=80", "--mlockall",
                            "--default-system", "--threads=1", "--histogram="}) {
    EXPECT_THAT(command, HasSubstr(words));
  }
  EXPECT_THAT(command, testing::Not(HasSubstr("affinity")));
  EXPECT_THAT(cyclictestCommand({.fifo = false}), HasSubstr("--policy=other"));
}

}  // namespace lateness_test
}  // namespace palpate
