// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/goal.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace goal_test {

using testing::ElementsAre;
using testing::IsEmpty;

Trial trial(double error_N, double loop_us, std::uint64_t memory_bytes = 1'000'000, double start_ms = 100) {
  return {
      .error_N = error_N, .loop_us = loop_us, .memory_bytes = memory_bytes, .start_ms = start_ms, .contact_share = 1};
}
const Trial kBase = trial(0.01, 5);
const Goal kError{Goal::Kind::kError, 0.1};
const Goal kBudget{Goal::Kind::kBudget, 10};

TEST(Goal, IsMetWithItsMargin) {
  EXPECT_TRUE(meets(kError, trial(0.1 / kErrorMargin * 0.999, 1000), kBase));
  EXPECT_FALSE(meets(kError, trial(0.1 / kErrorMargin * 1.001, 1), kBase));
  EXPECT_TRUE(meets(kBudget, trial(1000, 10 / kTimeMargin * 0.999), kBase));
  EXPECT_FALSE(meets(kBudget, trial(0, 10 / kTimeMargin * 1.001), kBase));
}

TEST(Goal, IsNotMetWithoutTheContact) {
  Trial lost = trial(0, 0), faulty = trial(0, 0), unknown = trial(std::nan(""), 0), impossible = trial(0, 0);
  lost.contact_share = 0.98;
  faulty.faulty_ticks = 1;
  impossible.impossible = "too large";
  for (const Trial& t : {lost, faulty, unknown, impossible}) {
    EXPECT_FALSE(holdsContact(t, kBase));
    EXPECT_FALSE(meets(kError, t, kBase));
    EXPECT_FALSE(meets(kBudget, t, kBase));
  }
  lost.contact_share = 0.995;
  EXPECT_TRUE(meets(kError, lost, kBase));
}

// Times within a tenth count as equal, memories within a hundredth, starts within a quarter.
TEST(Goal, AnErrorRanksByTimeThenMemoryThenStartThenError) {
  EXPECT_THAT(ranked(kError, std::vector{trial(0.01, 9), trial(0.05, 5), trial(0.2, 1)}, kBase, {}), ElementsAre(1, 0));
  EXPECT_THAT(ranked(kError, std::vector{trial(0.05, 5), trial(0.05, 5.4, 900'000)}, kBase, {}), ElementsAre(1, 0));
  EXPECT_THAT(ranked(kError, std::vector{trial(0.05, 5, 1'005'000, 90), trial(0.05, 5, 1'000'000, 120)}, kBase, {}),
              ElementsAre(0, 1));
  EXPECT_THAT(ranked(kError, std::vector{trial(0.05, 5, 1'000'000, 110), trial(0.04, 5)}, kBase, {}),
              ElementsAre(1, 0));
  EXPECT_THAT(ranked(kError, std::vector{trial(0.2, 1)}, kBase, {}), IsEmpty());
}

// Which of equal ones came first is chance: the scene's own settings win, and of the others the truest.
TEST(Goal, EqualOnesRankByWhatTheyChange) {
  std::vector<Trial> trials = {trial(0.01, 5.1), trial(0.02, 5), trial(0.03, 5.2), trial(0.001, 5)};
  trials[0].candidate = {.samples = "half", .n = 3};
  trials[1].candidate = {.samples = "half"};
  trials[3].candidate = {.filter = "median:1", .samples = "half", .n = 3};
  EXPECT_THAT(ranked(kError, trials, kBase, {}), ElementsAre(2, 1, 0, 3));
  EXPECT_THAT(ranked(kError, trials, kBase, {.samples = "half", .n = 3}), ElementsAre(0, 3, 1, 2));
  EXPECT_EQ(countAsGood(kError, trials, kBase), 4U);
  trials[2].loop_us = 5.6;
  EXPECT_EQ(countAsGood(kError, trials, kBase), 3U);
  EXPECT_EQ(countAsGood(kError, {}, kBase), 0U);
  for (Trial& t : trials) t.error_N = 0.02;
  EXPECT_THAT(ranked({Goal::Kind::kBudget, 7.2}, trials, kBase, {.samples = "half", .n = 3}), ElementsAre(0, 1, 3));
}

TEST(Goal, ABudgetRanksByErrorThenCost) {
  EXPECT_THAT(ranked(kBudget, std::vector{trial(0.05, 2), trial(0.01, 7), trial(0.001, 9)}, kBase, {}),
              ElementsAre(1, 0));
  EXPECT_THAT(ranked(kBudget, std::vector{trial(0.01, 7), trial(0.0101, 2)}, kBase, {}), ElementsAre(1, 0));
}

TEST(Goal, TheNearestIsTheLeastFigureWithContact) {
  Trial lost = trial(0.001, 0.001);
  lost.contact_share = 0;
  const std::vector<Trial> trials = {lost, trial(std::nan(""), 0), trial(0.5, 20), trial(0.4, 30)};
  EXPECT_EQ(nearestTo(kError, trials, kBase), 3U);
  EXPECT_EQ(nearestTo(kBudget, trials, kBase), 2U);
}

}  // namespace goal_test
}  // namespace palpate
