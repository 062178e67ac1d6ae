// SPDX-License-Identifier: Apache-2.0
#include "apps/bench/cyclictest.hpp"

#include <gmock/gmock.h>

namespace palpate {
namespace cyclictest_test {

using testing::HasSubstr;

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

}  // namespace cyclictest_test
}  // namespace palpate
