// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/candidate.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace palpate {
namespace candidate_test {

const Candidate kOther{"sobel", "gaussian:1", "half", 8, 12};

TEST(Candidate, GoesIntoASceneAndComesBack) {
  EXPECT_EQ(candidateOf(Scene{}), Candidate{});
  EXPECT_EQ(candidateOf(withCandidate(Scene{}, kOther)), kOther);
}

TEST(Candidate, DiffersOnOneChoiceAlone) {
  for (const Axis axis : kAxes) EXPECT_FALSE(differOnlyOn(axis, kOther, kOther));
  Candidate near = kOther;
  near.n = 5;
  for (const Axis axis : kAxes) EXPECT_EQ(differOnlyOn(axis, near, kOther), axis == Axis::kN);
  near.window_edge = 16;
  for (const Axis axis : kAxes) EXPECT_FALSE(differOnlyOn(axis, near, kOther));
}

TEST(Candidate, NamesItsValues) {
  EXPECT_EQ(valueOn(Axis::kFilter, Candidate{}), "none");
  EXPECT_EQ(valueOn(Axis::kFilter, kOther), "gaussian:1");
  EXPECT_EQ(valueOn(Axis::kN, kOther), "8");
}

TEST(Trial, KeepsTheWorseOfTwoRuns) {
  Trial trial{.error_N = 0.1, .loop_us = 3, .contact_share = 0.9, .faulty_ticks = 0};
  keepWorse(trial, {.error_N = 0.05, .loop_us = 9, .contact_share = 0.8, .faulty_ticks = 2});
  EXPECT_EQ(trial.error_N, 0.1);
  EXPECT_EQ(trial.loop_us, 3);
  EXPECT_EQ(trial.contact_share, 0.8);
  EXPECT_EQ(trial.faulty_ticks, 2);
  EXPECT_EQ(trial.impossible, "");
  keepWorse(trial, {.impossible = "no memory"});
  EXPECT_EQ(trial.impossible, "no memory");
  EXPECT_TRUE(std::isnan(trial.error_N));
  keepWorse(trial, {.error_N = 0.2});
  EXPECT_TRUE(std::isnan(trial.error_N));
}

}  // namespace candidate_test
}  // namespace palpate
