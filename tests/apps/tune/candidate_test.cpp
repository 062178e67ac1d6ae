// SPDX-License-Identifier: Apache-2.0
#include "apps/tune/candidate.hpp"

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

}  // namespace candidate_test
}  // namespace palpate
