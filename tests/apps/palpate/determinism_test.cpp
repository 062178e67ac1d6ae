// SPDX-License-Identifier: Apache-2.0
// With the simulated clock, the same scene gives the same trace, bit for bit, wherever and how often it is run.
#include "program_test.hpp"

namespace palpate {
namespace determinism_test {

class Determinism : public ProgramTest, public testing::WithParamInterface<Words> {};

TEST_P(Determinism, TwoRunsGiveTheSameTrace) {
  const Words base = {
      "touch", "phantom:knot?size=32&noise=0.02", "--seconds", "0.3", "--clock", "simulated", "--picture", "off"};
  expectSuccess(run(base + GetParam() + Words{"--out", "first"}));
  expectSuccess(run(base + GetParam() + Words{"--out", "second"}));
  const std::string first = contentsOf(file("first/trace.csv"));
  EXPECT_GT(first.size(), 10000U);
  EXPECT_TRUE(first == contentsOf(file("second/trace.csv"))) << "the traces differ";
}

INSTANTIATE_TEST_SUITE_P(Modes, Determinism,
                         testing::Values(Words{}, Words{"--hand", "spring"},
                                         Words{"--algorithm", "hri-paper", "--n", "1"},
                                         Words{"--gradient", "all", "--rate", "4000"},
                                         Words{"--hand", "spring", "--stiffness", "2000", "--delay", "2", "--encoder",
                                               "0.001", "--velocity", "foaw", "--passivity", "control"}));

class DeterminismOfWork : public ProgramTest {};

// What is computed besides must not change what is felt.
TEST_F(DeterminismOfWork, GradientsOfAllBricksChangeNothing) {
  expectSuccess(run(quickTouch("phantom:knot?size=32")));
  const std::string active = contentsOf(file("out/trace.csv"));
  expectSuccess(run(quickTouch("phantom:knot?size=32", {"--gradient", "all"})));
  EXPECT_TRUE(active == contentsOf(file("out/trace.csv")));
}

}  // namespace determinism_test
}  // namespace palpate
