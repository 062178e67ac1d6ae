// SPDX-License-Identifier: Apache-2.0
// Truth: every choice compared with every other one.
#include "apps/study/pareto_front.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>

namespace palpate {
namespace pareto_front_test {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

std::vector<std::size_t> byBruteForce(const std::vector<CostAndError>& choices) {
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const auto& [cost, error] = choices[i];
    bool beaten = std::isnan(cost) || std::isnan(error);
    for (const auto& [other_cost, other_error] : choices) {
      beaten = beaten || (other_cost <= cost && other_error < error) || (other_cost < cost && other_error <= error);
    }
    if (!beaten) front.push_back(i);
  }
  return front;
}

// Few different values, so that equal costs, equal errors and equal choices are frequent; some NaN, some infinite.
TEST(ParetoFront, IsWhatNoOtherChoiceBeats) {
  std::mt19937 bits(1);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto values = 1 + bits() % (trial % 2 == 0 ? 6 : 1000);
    const auto figure = [&] {
      const auto kind = bits() % 40;
      if (kind == 0) return std::numeric_limits<double>::quiet_NaN();
      if (kind == 1) return std::numeric_limits<double>::infinity();
      return static_cast<double>(bits() % values);
    };
    std::vector<CostAndError> choices(bits() % 60);
    for (CostAndError& choice : choices) choice = {figure(), figure()};
    const std::vector<std::size_t> front = paretoFront(choices);
    ASSERT_THAT(front, UnorderedElementsAreArray(byBruteForce(choices)));
    for (std::size_t i = 1; i < front.size(); ++i) ASSERT_LE(choices[front[i - 1]].cost, choices[front[i]].cost);
  }
}

TEST(ParetoFront, OfEqualChoicesAllAreOnIt) {
  EXPECT_THAT(paretoFront({{2, 2}, {1, 3}, {2, 2}, {3, 2}}), ElementsAre(1, 0, 2));
  EXPECT_THAT(paretoFront({}), IsEmpty());
}

TEST(ParetoFront, NoChoiceDominatesItself) {
  EXPECT_FALSE(dominates({1, 1}, {1, 1}));
  EXPECT_TRUE(dominates({1, 1}, {1, 2}));
  EXPECT_TRUE(dominates({1, 1}, {2, 1}));
  EXPECT_FALSE(dominates({1, 2}, {2, 1}));
  EXPECT_FALSE(dominates({1, std::nan("")}, {2, 1}));
}

}  // namespace pareto_front_test
}  // namespace palpate
