// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, and what `kill` and `timeout` send, end a run in good order: soon, in one line, with nothing left behind.
#include <csignal>

#include "engine/journal/journal_writer.hpp"
#include "engine/volume/statistics.hpp"
#include "engine/volume/volume_file.hpp"
#include "program_test.hpp"

namespace palpate {
namespace {

class Interrupt : public ProgramTest {
 protected:
  [[nodiscard]] Outcome interrupted(const Words& more, const std::string& at, const std::vector<int>& signals,
                                    const std::string& with = "") const {
    return runPalpate(
        {.arguments = Words{"touch", "phantom:sphere?size=24", "--picture", "off", "--out", "a/out"} + more,
         .folder = folder(),
         .signal_at = at,
         .signal_with = with,
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

// While the engine begins: a diffusion of minutes.
TEST_F(Interrupt, OfTheFiltersOfARun) {
  const Outcome outcome =
      runPalpate({.arguments = {"touch", "phantom:knot?size=160&noise=0.05", "--picture", "off", "--filter",
                                "diffuse:500:kappa=100 diffuse:500:kappa=100", "--out", "a/out"},
                  .folder = folder(),
                  .signal_at = "computing on Vulkan: filter",
                  .signals = {SIGINT}});
  expectGoodOrder(outcome);
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

const Words kDrill = {"--edit", "remove:radius=1mm:period=20", "--journal", "journal", "--save", "s.vdb"};

// What was saved is told, and is there. The tool touches after a sixth of the run, and is stopped at the first save.
TEST_F(Interrupt, OfARunThatIsSaved) {
  const Outcome outcome =
      interrupted(kDrill + Words{"--seconds", "25", "--save-every", "0.2"}, "palpating", {SIGINT}, "s.vdb");
  expectGoodOrder(outcome);
  EXPECT_THAT(outcome.err, testing::ContainsRegex("s.vdb holds the volume up to edit [1-9][0-9]*"));
  EXPECT_THAT(outcome.err, testing::HasSubstr("the journal journal holds edits up to number"));
  EXPECT_THAT(outcome.err, testing::Not(testing::HasSubstr("nothing was written")));
  EXPECT_TRUE(exists("s.vdb"));
  expectSuccess(run({"recover", "journal", "--out", "back.vdb"}));
}

// Minutes of edits: each of 200,000 fills or clears a ball of 32 voxels. To apply them all takes longer than is waited.
TEST_F(Interrupt, OfARecovery) {
  const Volume volume = loadVolume("phantom:sphere?size=64");
  {
    JournalWriter writer(file("journal"), {identityOf(volume), brushProfile(volume, defaultIsovalue(volume))});
    for (int i = 0; i < 200'000; ++i) {
      EditCommand command;
      command.kind = i % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
      command.from_W = command.to_W = volume.lattice().toWorld(Vec3(32, 32, 32));
      command.radius_m = 16 * volume.lattice().smallestSpacing();
      writer.edit({&command, 1});
    }
  }
  const Outcome outcome = runPalpate({.arguments = {"recover", "journal", "--out", "back.vdb"},
                                      .folder = folder(),
                                      .signal_at = "applying the edits",
                                      .signals = {SIGINT},
                                      .timeout_s = 30});
  expectRefusal(outcome, "palpate recover", "stopped by the user", 130);
  EXPECT_FALSE(exists("back.vdb"));
}

// Before the first edit nothing hinders the same command from being given again.
TEST_F(Interrupt, BeforeTheFirstEditLeavesNoJournal) {
  const Words far = {"--seconds", "600", "--approach", "500"};
  expectGoodOrder(interrupted(kDrill + far, "palpating", {SIGINT}));
  EXPECT_FALSE(exists("journal/journal.palpate"));
}

}  // namespace
}  // namespace palpate
