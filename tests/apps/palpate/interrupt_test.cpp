// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, and what `kill` and `timeout` send, end a run in good order: soon, in one line, with nothing left behind.
#include <algorithm>
#include <csignal>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_writer.hpp"
#include "program_test.hpp"
#include "promised_end.hpp"

namespace palpate {
namespace interrupt_test {

using testing::HasSubstr;

// The signal comes each time where the stage begins, so that no time is short because the work was nearly done.
void expectSoon(Command command, const Outcome& first) {
  EXPECT_GT(first.signalled_s, 0) << "no signal was sent";
  double shortest_s = first.seconds - first.signalled_s;
  for (int tries = 1; tries < kTriesToEnd && shortest_s >= kPromisedEnd_s && kEndIsPromised; ++tries) {
    const TemporaryFolder fresh;
    command.folder = fresh.path();
    const Outcome again = runPalpate(command);
    EXPECT_EQ(again.status, 130) << again.err;
    shortest_s = std::min(shortest_s, again.seconds - again.signalled_s);
  }
  if (kEndIsPromised) {
    EXPECT_LT(shortest_s, kPromisedEnd_s);
  }
}

class Interrupt : public ProgramTest {
 protected:
  [[nodiscard]] Command touching(const Words& more, const std::string& at, const std::vector<int>& signals,
                                 const std::string& with = "") const {
    const bool is_simulated = std::ranges::find(more, "simulated") != more.end();
    const double some_ticks_s = is_simulated ? 0.2 : 0.5;  // the former makes them as fast as it can
    return {.arguments = Words{"touch", "phantom:sphere?size=24", "--picture", "off", "--out", "a/out"} + more,
            .folder = folder(),
            .signal_at = at,
            .signal_with = with,
            .signal_delay_s = at == "palpating" ? some_ticks_s : 0,
            .signals = signals};
  }
  [[nodiscard]] Outcome interrupted(const Words& more, const std::string& at, const std::vector<int>& signals,
                                    const std::string& with = "") const {
    return runPalpate(touching(more, at, signals, with));
  }
  void expectNothing(const Outcome& outcome) const {
    expectRefusal(outcome, "palpate touch", "stopped by the user", 130);
    EXPECT_LT(outcome.seconds, 30);  // of a run of minutes
    EXPECT_FALSE(exists("a"));
  }
  // What was felt is there, whole, and every file says that there might have been more.
  void expectKept(const Outcome& outcome, double wanted_s) const {
    expectRefusal(outcome, "palpate touch", fmt::format("s of {:g} s; what was felt is in a/out", wanted_s), 130);
    EXPECT_THAT(outcome.err, HasSubstr("stopped by the user after"));
    EXPECT_LT(outcome.seconds, 60);  // of a run of minutes
    EXPECT_THAT(outcome.out, HasSubstr("\nEnded     early: stopped by the user after "));
    const auto summary = nlohmann::json::parse(contentsOf(file("a/out/summary.json")));
    const auto ended = summary["ended_early"].get<std::string>();
    EXPECT_THAT(ended, testing::StartsWith("stopped by the user after "));
    EXPECT_THAT(ended, testing::EndsWith(fmt::format(" s of {:g} s", wanted_s)));
    EXPECT_THAT(summary["verdict"].get<std::string>(), testing::StartsWith("Ended early: " + ended + ". "));
    EXPECT_THAT(contentsOf(file("a/out/report.html")), HasSubstr("Ended early: " + ended + ". "));
    Words rows;
    std::ifstream trace(file("a/out/trace.csv"));
    for (std::string line; std::getline(trace, line);) rows.push_back(line);
    ASSERT_GE(rows.size(), 3U);
    EXPECT_EQ(rows.back(), "# " + ended);
    EXPECT_EQ(rows.size() - 2, summary["servo"]["ticks"].get<std::size_t>());
    for (const auto& phase : summary["phases"])
      EXPECT_LE(phase["end_s"].get<double>(), summary["servo"]["time_s"].get<double>() + 1e-9);
    const auto files = std::distance(std::filesystem::directory_iterator(file("a/out")), {});
    EXPECT_EQ(files, 3);  // no draft, no picture
  }
};

TEST_F(Interrupt, OfARunInRealTime) {
  const Command command = touching({"--seconds", "600"}, "palpating", {SIGINT});
  const Outcome outcome = runPalpate(command);
  expectKept(outcome, 600);
  expectSoon(command, outcome);
}

// Between two runs of the scene, and within one.
TEST_F(Interrupt, OfATuningWritesNothing) {
  for (const char* seconds : {"2", "2000"}) {
    const Command command = {
        .arguments = {"tune", "phantom:sphere?size=24", "--seconds", seconds, "--error", "0.05N", "--json", "t.json"},
        .folder = folder(),
        .signal_at = "at most",
        .signal_delay_s = 0.2,
        .signals = {SIGINT}};
    const Outcome outcome = runPalpate(command);
    expectRefusal(outcome, "palpate tune", "stopped by the user; nothing was written", 130);
    EXPECT_TRUE(std::filesystem::is_empty(folder()));
    expectSoon(command, outcome);
  }
}

TEST_F(Interrupt, OfARunOnTheSimulatedClock) {
  // However many ticks the machine makes of the time until the signal. All are in the trace, so no time is promised.
  const Words run_of = {"--seconds", "120", "--rate", "20000", "--clock", "simulated", "--stopped-trace", "1000000000"};
  expectKept(interrupted(run_of, "palpating", {SIGINT}), 120);
}

// A long trace would keep the user waiting: it is left out, which is told with the flag that brings it. What goes on is
// told at once. So the simulated servo and the report of what it felt end within the time that is promised.
TEST_F(Interrupt, OfALongRunLeavesTheTraceOut) {
  const Words run_of = {"--seconds", "2000", "--rate", "1000", "--clock", "simulated", "--stopped-trace", "1"};
  const Command command = touching(run_of, "palpating", {SIGINT});
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate touch", "s of 2000 s, without trace.csv (--stopped-trace ", 130);
  EXPECT_THAT(outcome.err, testing::ContainsRegex("stopping: writing the report of [0-9]+ ticks; "
                                                  "Ctrl-C again gives it up \\.\\.\\.\n"));
  EXPECT_FALSE(exists("a/out/trace.csv"));
  const auto summary = nlohmann::json::parse(contentsOf(file("a/out/summary.json")));
  const auto ticks = summary["servo"]["ticks"].get<std::size_t>();
  const std::string flag = fmt::format("(--stopped-trace {} writes it for so many ticks)", ticks);
  EXPECT_THAT(summary["ended_early"].get<std::string>(), HasSubstr(flag));
  EXPECT_THAT(summary["verdict"].get<std::string>(), HasSubstr(flag));
  EXPECT_EQ(summary["files"], (nlohmann::json{"a/out/report.html", "a/out/summary.json"}));
  expectSoon(command, outcome);
}

// The run is whole, and its trace takes some 2 us a tick to write: it is given up, at the first request.
TEST_F(Interrupt, OfALongTrace) {
  const Command command = {
      .arguments = {"touch", "phantom:sphere?size=24", "--picture", "off", "--seconds", "20", "--rate", "20000",
                    "--clock", "simulated", "--out", "out", "--stopped-trace", "1000"},
      .folder = folder(),
      .signal_at = "writing out",
      .signals = {SIGINT}};
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate touch",
                "stopped by the user after the run, without trace.csv (--stopped-trace 400000 writes it", 130);
  EXPECT_FALSE(exists("out/trace.csv"));
  const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["servo"]["ticks"], 400'000);
  EXPECT_EQ(summary["files"].size(), 2U);
  expectSoon(command, outcome);
}

TEST_F(Interrupt, BeforeTheRunBegins) {
  expectNothing(interrupted({"--seconds", "600"}, "loading", {SIGINT}));
}

// The run is whole, its picture is not begun or not finished: a picture of many megapixels in which nothing is skipped.
TEST_F(Interrupt, OfThePicture) {
  const Command command = {.arguments = {"touch", "phantom:sphere?size=64", "--seconds", "0.3", "--clock", "simulated",
                                         "--width", "3840", "--height", "3840", "--out", "out"},
                           .folder = folder(),
                           .signal_at = "drawing",
                           .signals = {SIGINT}};
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate touch",
                "stopped by the user after the run, before the picture; what was felt is in out", 130);
  EXPECT_FALSE(exists("out/view.png"));
  const auto summary = nlohmann::json::parse(contentsOf(file("out/summary.json")));
  EXPECT_EQ(summary["ended_early"], "stopped by the user after the run, before the picture");
  EXPECT_EQ(summary["servo"]["ticks"], 300);
  EXPECT_EQ(summary["files"].size(), 3U);
  expectSoon(command, outcome);
}

// Of noise, whose surface is everywhere: a mesh of seconds. The mesher does not look, so it is ended from outside.
TEST_F(Interrupt, OfAMesh) {
  const Command command = {.arguments = {"convert", "phantom:random?size=128", "o.ply"},
                           .folder = folder(),
                           .signal_at = "meshing",
                           .signals = {SIGINT}};
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate convert", "stopped by the user", 130);
  EXPECT_FALSE(exists("o.ply"));
  expectSoon(command, outcome);
}

// A run that nobody stops says nothing of it.
TEST_F(Interrupt, IsNotToldWhereThereWasNone) {
  expectSuccess(run(quickTouch("phantom:sphere?size=24")));
  EXPECT_TRUE(nlohmann::json::parse(contentsOf(file("out/summary.json")))["ended_early"].is_null());
  EXPECT_THAT(contentsOf(file("out/trace.csv")), testing::Not(HasSubstr("#")));
  EXPECT_THAT(contentsOf(file("out/report.html")), testing::Not(HasSubstr("Ended early")));
}

// While the engine begins: a diffusion of minutes.
TEST_F(Interrupt, OfTheFiltersOfARun) {
  const Command command = {.arguments = {"touch", "phantom:knot?size=160&noise=0.05", "--picture", "off", "--filter",
                                         "diffuse:500:kappa=100 diffuse:500:kappa=100", "--out", "a/out"},
                           .folder = folder(),
                           .signal_at = "computing on Vulkan: filter",
                           .signals = {SIGINT}};
  const Outcome outcome = runPalpate(command);
  expectNothing(outcome);
  expectSoon(command, outcome);
}

TEST_F(Interrupt, OfACheck) {
  const Command command = {.arguments = {"check", "all"},
                           .folder = folder(),
                           .environment = {{"PALPATE_DATA", folder().string()}},
                           .signal_at = "checking",
                           .signals = {SIGINT}};
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate check", "stopped by the user", 130);
  EXPECT_LT(outcome.seconds, 30);
  expectSoon(command, outcome);
}

// `timeout` signals its child and then the child's group, so one request arrives twice.
TEST_F(Interrupt, ThatArrivesTwiceAtOnce) {
  expectKept(interrupted({"--seconds", "600"}, "palpating", {SIGTERM, SIGTERM}), 600);
}

const Words kDrill = {"--edit", "remove:radius=1mm:period=20", "--journal", "journal", "--save", "s.vdb"};

// What was saved is told, and is there. The tool touches after a sixth of the run, and is stopped at the first save.
TEST_F(Interrupt, OfARunThatIsSaved) {
  const Outcome outcome =
      interrupted(kDrill + Words{"--seconds", "25", "--save-every", "0.2"}, "palpating", {SIGINT}, "s.vdb");
  expectKept(outcome, 25);
  EXPECT_THAT(outcome.err, testing::ContainsRegex("s.vdb holds the volume up to edit [1-9][0-9]*"));
  EXPECT_THAT(outcome.err, testing::HasSubstr("the journal journal holds edits up to number"));
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
  const Command command = {.arguments = {"recover", file("journal").string(), "--out", "back.vdb"},
                           .folder = folder(),
                           .signal_at = "applying the edits",
                           .signals = {SIGINT},
                           .timeout_s = 30};
  const Outcome outcome = runPalpate(command);
  expectRefusal(outcome, "palpate recover", "stopped by the user", 130);
  EXPECT_FALSE(exists("back.vdb"));
  expectSoon(command, outcome);
}

// Before the first edit nothing hinders the same command from being given again.
TEST_F(Interrupt, BeforeTheFirstEditLeavesNoJournal) {
  const Words far = {"--seconds", "600", "--approach", "500"};
  expectKept(interrupted(kDrill + far, "palpating", {SIGINT}), 600);
  EXPECT_FALSE(exists("journal/journal.palpate"));
}

}  // namespace interrupt_test
}  // namespace palpate
