// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, and what `kill` and `timeout` send, end a run in good order: soon, in one line, with nothing left behind.
#include <csignal>

#include "program_test.hpp"

namespace palpate {
namespace {

class Interrupt : public ProgramTest {
 protected:
  [[nodiscard]] Outcome interrupted(const Words& more, const std::string& at, const std::vector<int>& signals) const {
    return runPalpate(
        {.arguments = Words{"touch", "phantom:sphere?size=24", "--picture", "off", "--out", "a/out"} + more,
         .folder = folder(),
         .signal_at = at,
         .signals = signals});
  }
  void expectGoodOrder(const Outcome& outcome) const {
    expectRefusal(outcome, "palpate touch", "stopped by the user", 130);
    EXPECT_LT(outcome.seconds, 30);  // of a run of minutes
    EXPECT_FALSE(exists("a"));
  }
};

TEST_F(Interrupt, OfARunInRealTime) {
  expectGoodOrder(interrupted({"--seconds", "600"}, "palpating", {SIGINT}));
}

TEST_F(Interrupt, OfARunOnTheSimulatedClock) {
  expectGoodOrder(interrupted({"--seconds", "120", "--rate", "20000", "--clock", "simulated"}, "palpating", {SIGINT}));
}

TEST_F(Interrupt, BeforeTheRunBegins) {
  expectGoodOrder(interrupted({"--seconds", "600"}, "loading", {SIGINT}));
}

TEST_F(Interrupt, OfACheck) {
  const Outcome outcome = runPalpate({.arguments = {"check", "all"},
                                      .folder = folder(),
                                      .environment = {{"PALPATE_DATA", folder().string()}},
                                      .signal_at = "checking",
                                      .signals = {SIGINT}});
  expectRefusal(outcome, "palpate check", "stopped by the user", 130);
  EXPECT_LT(outcome.seconds, 30);
}

// `timeout` signals its child and then the child's group, so one request arrives twice.
TEST_F(Interrupt, ThatArrivesTwiceAtOnce) {
  expectGoodOrder(interrupted({"--seconds", "600"}, "palpating", {SIGTERM, SIGTERM}));
}

}  // namespace
}  // namespace palpate
