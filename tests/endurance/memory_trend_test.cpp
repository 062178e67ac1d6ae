// SPDX-License-Identifier: Apache-2.0
// What is said of looks at a process's memory, on made-up ones.
#include "memory_trend.hpp"

#include <functional>

#include <gtest/gtest.h>

namespace palpate {
namespace memory_trend_test {

double growthOf(int looks, const std::function<double(int)>& memory) {
  std::vector<double> all;
  for (int i = 0; i < looks; ++i) all.push_back(memory(i));
  return palpate::growthOf(all);
}

TEST(MemoryTrend, IsFlatWhereNothingGrows) {
  EXPECT_EQ(growthOf(100, [](int) { return 50; }), 0);
  EXPECT_EQ(growthOf(4, [](int i) { return 1 + i; }), 0);  // too few looks
  // Caches fill in the first fifth, and a look in thirty falls into a save.
  EXPECT_EQ(growthOf(600, [](int i) { return i < 110 ? 10 + i : i % 30 == 0 ? 400 : 120; }), 0);
}

TEST(MemoryTrend, SeesWhatGrows) {
  EXPECT_NEAR(growthOf(1000, [](int i) { return 0.1 * i; }), 82.0 / 22 - 1, 0.02);  // of the tenth percentiles
  EXPECT_NEAR(growthOf(1000, [](int i) { return 100 + 0.01 * i; }), 0.06, 0.002);
}

// In either of two states, however long they last.
TEST(MemoryTrend, ComparesEachOfTwoStates) {
  const auto states = [](double low, double high) {
    return [=](int i) { return (i / 17) % 2 == 0 ? 50 * (1 + low * i) : 65 * (1 + high * i); };
  };
  EXPECT_NEAR(growthOf(1000, states(0, 0)), 0, 1e-12);
  EXPECT_NEAR(growthOf(1000, states(0, 1e-4)), 0.058, 0.01);
  EXPECT_NEAR(growthOf(1000, states(1e-4, 0)), 0.058, 0.01);
}

}  // namespace memory_trend_test
}  // namespace palpate
