// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/reasons.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace reasons_test {

Trial with(int n, double error_N, double loop_us) {
  Trial trial{.error_N = error_N, .loop_us = loop_us, .memory_bytes = 1'000'000, .start_ms = 100, .contact_share = 1};
  trial.candidate.n = n;
  return trial;
}
const Goal kError{Goal::Kind::kError, 0.05}, kBudget{Goal::Kind::kBudget, 4};

TEST(Reasons, OfAnOrderedChoiceNameTheNearestOnEachSide) {
  const std::vector<Trial> trials = {with(1, 0.001, 5), with(5, 0.02, 3), with(8, 0.03, 2), with(13, 0.07, 1.5),
                                     with(21, 0.2, 1)};
  EXPECT_EQ(reasonFor(Axis::kN, trials[2], trials, trials[0], kError), "13 errs by 0.07 N; 5 takes 1 us a tick more");
  EXPECT_EQ(reasonFor(Axis::kN, trials[1], trials, trials[0], kBudget), "8 errs by 0.03 N; 1 takes 5 us a tick");
  EXPECT_EQ(reasonFor(Axis::kWindow, trials[2], trials, trials[0], kError), "");
}

TEST(Reasons, SayWhatElseCosts) {
  std::vector<Trial> trials = {with(5, 0.03, 2), with(5, 0.03, 2), with(5, 0.03, 2)};
  trials[1].candidate.samples = "half";
  trials[1].memory_bytes = 3'097'152;
  EXPECT_EQ(reasonFor(Axis::kSamples, trials[0], trials, trials[0], kError), "half takes 2.0 MiB more");
  trials[2].candidate.filter = "median:1";
  trials[2].start_ms = 150;
  EXPECT_EQ(reasonFor(Axis::kFilter, trials[0], trials, trials[0], kError), "median:1 starts 50 ms later");
  trials[2].start_ms = 100;
  EXPECT_EQ(reasonFor(Axis::kFilter, trials[0], trials, trials[0], kError), "median:1 does as well");
  trials[2].impossible = "too large";
  EXPECT_EQ(reasonFor(Axis::kFilter, trials[0], trials, trials[0], kError), "median:1 cannot be: too large");
  trials[2].impossible.clear();
  trials[2].contact_share = 0.5;
  EXPECT_EQ(reasonFor(Axis::kFilter, trials[0], trials, trials[0], kError), "median:1 loses the contact");
}

}  // namespace reasons_test
}  // namespace palpate
