// SPDX-License-Identifier: Apache-2.0
// palpate touch --edit, --journal and palpate recover, as a user gives them.
#include <csignal>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_reader.hpp"
#include "engine/journal/volume_identity.hpp"
#include "program_test.hpp"
#include "tests/support/long_run.hpp"
#include "trace.hpp"

namespace palpate {
namespace live_edits_test {

using ::testing::HasSubstr;

constexpr const char* kVolume = "phantom:sphere?size=32";

class LiveEdits : public ProgramTest {
 protected:
  [[nodiscard]] nlohmann::json summary(const char* out = "out") const {
    return nlohmann::json::parse(contentsOf(file(out) / "summary.json"));
  }
};

const Words kDrill = {"--edit", "remove:radius=1mm"};

// A second with the simulated clock, without a picture.
Words touch(const Words& more = {}, const char* clock = "simulated") {
  return Words{"touch", kVolume, "--seconds", "1", "--clock", clock, "--picture", "off", "--out", "out"} + more;
}

TEST_F(LiveEdits, TheTraceShowsEveryVersionInStepAndTheSameOnEveryRun) {
  expectSuccess(run(touch(kDrill)));
  const std::string first = contentsOf(file("out") / "trace.csv");
  const Trace trace = readTrace(file("out") / "trace.csv");
  double version = 0;
  for (const TraceRow& row : trace.rows) {
    EXPECT_GE(row.editVersion(), version);
    EXPECT_LE(row.editVersion(), version + 1);
    version = row.editVersion();
  }
  EXPECT_GE(version, 5);
  EXPECT_EQ(summary()["edits"]["count"], version);
  EXPECT_GT(summary()["edits"]["edit_to_window_ms"]["p50"], 0);
  expectSuccess(run(touch(kDrill)));
  EXPECT_EQ(contentsOf(file("out") / "trace.csv"), first);
}

// The tool's strokes go on in their place, so of a ball of 2 mm less is missing than one stroke would leave.
TEST_F(LiveEdits, ABrushThatIsFineForTheVoxelsIsTold) {
  const Outcome outcome = run(touch({"--edit", "remove:radius=2mm:falloff=0.5"}));
  expectSuccess(outcome);
  EXPECT_THAT(outcome.err, HasSubstr("--edit remove:radius=2mm:falloff=0.5: its radius is 2 mm, 2 x 2 x 2 voxels; of "
                                     "what is within, it removes some 46 %"));
}

// The brush takes away all within a millimetre of the HIP: what was touched is gone with the window that comes next.
TEST_F(LiveEdits, ASurfaceThatIsRemovedLetsGoWithinOneWindow) {
  expectSuccess(run(touch(kDrill)));
  const Trace trace = readTrace(file("out") / "trace.csv");
  int renewed = 0;
  for (std::size_t i = 1; i < trace.rows.size(); ++i) {
    if (trace.rows[i].editVersion() == trace.rows[i - 1].editVersion()) continue;
    ++renewed;
    EXPECT_FALSE(trace.rows[i].inContact()) << "tick " << trace.rows[i].tick();
    EXPECT_EQ(trace.rows[i].force_N().norm(), 0) << "tick " << trace.rows[i].tick();
  }
  EXPECT_GE(renewed, 5);
}

// The tool adds a ball around itself each time that it touches. Without an edit a tick changes the force by K times the
// tool's way, 500 N/m of some 20 um; what an edit puts there comes in over 500 ticks, at most K times the ball's radius
// / 500 = 1 mN a tick. So no step may stand out from those of the same path without edits by more than that and what
// the plane's renewal turns: a tenth of the largest force is far above it and far below the 0.5 N that a ball of 1 mm
// would throw with.
TEST_F(LiveEdits, MaterialAroundTheToolPushesGently) {
  for (const char* algorithm : {"hri", "blezek", "implicit", "avila"}) {
    SCOPED_TRACE(algorithm);
    expectSuccess(run(touch({"--edit", "add:radius=1mm", "--algorithm", algorithm})));
    const Trace trace = readTrace(file("out") / "trace.csv");
    double largest_step_N = 0;
    for (std::size_t i = 1; i < trace.rows.size(); ++i) {
      if (trace.rows[i].editVersion() == trace.rows[i - 1].editVersion()) continue;
      const double step_N = trace.rows[i].force_N().norm() - trace.rows[i - 1].force_N().norm();
      largest_step_N = std::max(largest_step_N, step_N);
    }
    EXPECT_GE(trace.rows.back().editVersion(), 1);
    EXPECT_LT(largest_step_N, 0.05);
  }
}

// Both strokes of a mirror are one edit; the force that drills is in the trace, so the same run edits the same.
TEST_F(LiveEdits, FlattensAndMirrorsAndDrillsByForce) {
  for (const char* brush : {"flatten:radius=1mm:mirror=x", "remove:radius=1mm:rate=50:mirror=z"}) {
    SCOPED_TRACE(brush);
    expectSuccess(run(touch({"--edit", brush})));
    const std::string first = contentsOf(file("out") / "trace.csv");
    const double version = readTrace(file("out") / "trace.csv").rows.back().editVersion();
    EXPECT_GE(version, 1);
    EXPECT_EQ(summary()["edits"]["count"], version);
    expectSuccess(run(touch({"--edit", brush})));
    EXPECT_EQ(contentsOf(file("out") / "trace.csv"), first);
  }
}

// Normals of a smoothed field follow what the tool takes away: where it is gone nothing is felt, as with any operator,
// and the run edits the same each time.
TEST_F(LiveEdits, ASmoothedGradientFollows) {
  const Words smooth = kDrill + Words{"--gradient-operator", "gaussian:1", "--filter", "gaussian:0.7"};
  expectSuccess(run(touch(smooth)));
  const std::string first = contentsOf(file("out") / "trace.csv");
  const Trace trace = readTrace(file("out") / "trace.csv");
  EXPECT_GE(trace.rows.back().editVersion(), 5);
  EXPECT_EQ(summary()["edits"]["count"], trace.rows.back().editVersion());
  expectSuccess(run(touch(smooth)));
  EXPECT_EQ(contentsOf(file("out") / "trace.csv"), first);
  expectSuccess(run(touch(kDrill + Words{"--filter", "gaussian:0.7"})));
  EXPECT_NE(contentsOf(file("out") / "trace.csv"), first);
}

// The engine's own thread edits; the versions still only rise, and what is saved gives the volume back.
TEST_F(LiveEdits, TheRealClockEditsToo) {
  expectSuccess(run(touch({"--edit", "remove:radius=1mm:strength=0.05", "--journal", "journal"}, "real")));
  double version = 0;
  for (const TraceRow& row : readTrace(file("out") / "trace.csv").rows) {
    EXPECT_GE(row.editVersion(), version);
    version = row.editVersion();
  }
  EXPECT_GE(summary()["edits"]["count"], 1);
  EXPECT_EQ(summary()["edits"]["journal_saved"], summary()["edits"]["count"]);
  expectSuccess(run({"recover", "journal", "--out", "back.vdb"}));
}

TEST_F(LiveEdits, WithoutABrushNothingChanges) {
  expectSuccess(run(touch()));
  EXPECT_TRUE(summary()["edits"].is_null());
  for (const TraceRow& row : readTrace(file("out") / "trace.csv").rows) EXPECT_EQ(row.editVersion(), 0);
}

TEST_F(LiveEdits, AJournalGivesTheVolumeBack) {
  const Outcome touched = run(touch(kDrill + Words{"--journal", "journal"}));
  expectSuccess(touched);
  EXPECT_THAT(touched.out, HasSubstr("journal records saved in journal"));
  const auto edits = summary()["edits"];
  EXPECT_EQ(edits["journal_saved"], edits["count"]);
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  expectSuccess(recovered);
  EXPECT_THAT(recovered.out, HasSubstr(fmt::format("Journal   {} edits", edits["count"].get<int>())));
  expectSuccess(run({"info", "back.vdb"}));
  // Nothing is left over, and a second session does not write over the first.
  for (const auto& entry : std::filesystem::directory_iterator(folder()))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("palpate-part")));
  expectRefusal(run(touch(kDrill + Words{"--journal", "journal"})), "journal", "another session", 2);
}

// "content 0123456789abcdef" of what `recover` printed.
std::string contentIn(const std::string& out) {
  const std::size_t at = out.find("content ");
  return at == std::string::npos ? "" : out.substr(at + 8, 16);
}

// Densities of the phantom are above 0 inside.
double objectVoxels(const Volume& volume) {
  const std::vector<float> values = volume.toDense();
  return static_cast<double>(std::count_if(values.begin(), values.end(), [](float v) { return v > 0; }));
}

std::string contentOf(const std::filesystem::path& volume) {
  return fmt::format("{:016x}", contentHash(loadVolume(volume.string())));
}

// Ctrl-C on the way to the surface, which takes 90 s here. The journal has no record: it is deleted and not named. Nor
// is the path to blame.
TEST_F(LiveEdits, ARunThatEndsBeforeTheSurfaceNamesNoJournal) {
  Words words = touch(kDrill + Words{"--journal", "journal", "--save", "sculpted.vdb"}, "real");
  words[3] = "600";
  const Outcome outcome = runPalpate(
      {.arguments = words, .folder = folder(), .signal_at = "palpating", .signal_delay_s = 0.2, .signals = {SIGINT}});
  expectRefusal(outcome, "palpate touch", "what was felt is in out", 130);
  EXPECT_FALSE(std::filesystem::exists(journalFile(file("journal"))));
  EXPECT_THAT(outcome.out, testing::Not(HasSubstr("journal")));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("journal")));
  EXPECT_THAT(outcome.out, HasSubstr("Note      nothing was touched until the run was ended"));
  EXPECT_EQ(summary()["edits"]["journal_bytes"], 0);
  EXPECT_THAT(contentsOf(file("out/report.html")), testing::Not(HasSubstr("records acknowledged")));
}

// In the corner of the volume, 26 mm from the middle of a ball in a volume of 32 mm.
TEST_F(LiveEdits, AWholeRunWithoutAnEditKeepsItsJournal) {
  write("way.csv", "time_s,x_m,y_m,z_m\n0,0.015,0.015,0.015\n0.1,0.015,0.015,0.014\n");
  const Outcome outcome = run(quickTouchAlong("way.csv", kVolume, kDrill + Words{"--journal", "journal"}));
  expectSuccess(outcome);
  EXPECT_THAT(outcome.out, HasSubstr("; 0 of 0 journal records saved in journal, "));
  EXPECT_THAT(outcome.out, HasSubstr("Note      nothing was touched: the path meets no surface"));
  EXPECT_EQ(summary()["edits"]["journal_bytes"], std::filesystem::file_size(journalFile(file("journal"))));
}

// A run says what it made of the volume, in the words of the verbs that make the same of its journal.
TEST_F(LiveEdits, ARunPrintsTheContentThatRecoverPrints) {
  const double voxels = objectVoxels(loadVolume(kVolume));
  for (const Words& save : {Words{}, Words{"--save", "sculpted.vdb", "--save-every", "0.2"}}) {
    std::filesystem::remove_all(file("journal"));
    const Outcome touched = run(touch(kDrill + save + Words{"--journal", "journal"}));
    expectSuccess(touched);
    const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
    EXPECT_THAT(contentIn(touched.out), testing::MatchesRegex("[0-9a-f]{16}"));
    EXPECT_EQ(contentIn(touched.out), contentIn(recovered.out));
    EXPECT_EQ(summary()["edits"]["content"], contentIn(touched.out));
    const double removed_m3 = (voxels - objectVoxels(loadVolume(file("back.vdb").string()))) * 1e-9;  // voxels of 1 mm
    EXPECT_GT(removed_m3, 0);
    EXPECT_NEAR(summary()["edits"]["added_m3"].get<double>(), -removed_m3, 1e-15);
    EXPECT_THAT(touched.out, HasSubstr("Volume    removed "));
  }
}

TEST_F(LiveEdits, RecoverWritesEveryFormat) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  for (const char* name : {"back.vdb", "back.nii", "back.nii.gz", "back.nrrd", "back.mha"}) {
    const Outcome recovered = run({"recover", "journal", "--out", name});
    expectSuccess(recovered);
    EXPECT_EQ(contentIn(recovered.out), contentOf(file(name))) << name;
  }
}

// The journal is nothing without the volume that it began with.
TEST_F(LiveEdits, RecoverNeverReplacesTheVolumeThatTheJournalBeganWith) {
  expectSuccess(run({"convert", kVolume, "start.vdb"}));
  Words words = touch(kDrill + Words{"--journal", "journal"});
  words[1] = "start.vdb";
  expectSuccess(run(words));
  const std::string before = contentsOf(file("start.vdb"));
  expectRefusal(run({"recover", "journal", "--out", "start.vdb"}), "start.vdb", "it is the input", 2);
  EXPECT_EQ(contentsOf(file("start.vdb")), before);
}

TEST_F(LiveEdits, RecoverSaysWhatADamagedTailLost) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  std::string bytes = contentsOf(journalFile(file("journal")));
  write("journal/journal.palpate", bytes.substr(0, bytes.size() - 5));
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  EXPECT_EQ(recovered.status, 4) << recovered.err;  // as that of a session whose journal lost records
  EXPECT_EQ(contentIn(recovered.out), contentOf(file("back.vdb")));
  ASSERT_EQ(errorLines(recovered.err).size(), 1U) << recovered.err;
  EXPECT_THAT(errorLines(recovered.err)[0],
              HasSubstr("palpate: journal/journal.palpate ends in a record that was being written"));
  EXPECT_THAT(recovered.out,
              HasSubstr("Lost      journal/journal.palpate ends in a record that was being written when"));
  EXPECT_THAT(recovered.out, HasSubstr("1 record in"));
  EXPECT_THAT(recovered.out, HasSubstr("is cut short"));
}

// Of a service that was killed while it began: the journal of the one before still counts.
TEST_F(LiveEdits, RecoverFindsTheJournalThatCounts) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  const Outcome before = run({"recover", "journal", "--out", "back.vdb"});
  std::filesystem::create_directory(file("journal/earlier"));
  std::filesystem::rename(journalFile(file("journal")), journalFile(file("journal/earlier")));
  const Outcome moved = run({"recover", "journal", "--out", "again.vdb"});
  expectSuccess(moved);
  EXPECT_EQ(contentIn(moved.out), contentIn(before.out));
}

TEST_F(LiveEdits, RecoverRefusesWhatItCannotRecover) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  expectRefusal(run({"recover", "journal", "--out", "back.vdb", "--volume", "phantom:sphere?size=40"}), "size=40",
                "not the volume that the journal began with", 2);
  expectRefusal(run({"recover", "journal", "--out", "back.tiff"}), "back.tiff", "names no format", 2);
  expectRefusal(run({"recover", "nothing", "--out", "back.vdb"}), "nothing", "there is no such folder", 3);
  std::string bytes = contentsOf(journalFile(file("journal")));
  bytes[8] = 9;
  write("journal/journal.palpate", bytes);
  expectRefusal(run({"recover", "journal", "--out", "back.vdb"}), "journal", "format version 9", 2);
  EXPECT_FALSE(exists("back.vdb"));
}

TEST_F(LiveEdits, RefusesBrushesThatCannotBeMeant) {
  const std::pair<const char*, const char*> cases[] = {
      {"remove:radius=0mm", "no length above 0"},     {"remove:radius=nan", "is no number"},
      {"remove:radius=9m", "larger than the volume"}, {"cut:radius=2mm", "use flatten"},
      {"remove:radius=2mm:mirror=q", "is no axis"},   {"carve:radius=2mm", "no brush 'carve'"}};
  for (const auto& [brush, reason] : cases) {
    expectRefusal(run(touch({"--edit", brush})), "edit", reason, 2);
    EXPECT_FALSE(exists("out"));
  }
  expectRefusal(run(touch({"--journal", "journal"})), "--journal", "nothing is edited", 2);
  expectRefusal(run(touch(kDrill + Words{"--algorithm", "god-object"})), "--edit", "a mesh that is made once", 2);
}

// A run on what was saved touches the same surface without being told, and saves it again.
TEST_F(LiveEdits, TheSavedVolumeKeepsTheIsovalue) {
  expectSuccess(run(touch(kDrill + Words{"--iso", "150", "--save", "first.vdb"})));
  EXPECT_EQ(loadVolume(file("first.vdb").string()).facts().kept_isovalue, 150);
  Words words = touch(kDrill + Words{"--save", "second.vdb"});
  words[1] = "first.vdb";
  expectSuccess(run(words));
  EXPECT_EQ(summary()["volume"]["isovalue_density"], 150);
  EXPECT_EQ(loadVolume(file("second.vdb").string()).facts().kept_isovalue, 150);
}

// The file of the last save holds the volume that the journal gives back.
TEST_F(LiveEdits, ASaveHoldsEveryEdit) {
  for (const char* clock : {"simulated", "real"}) {
    for (const std::string name : {"sculpted.vdb", "sculpted.nii.gz"}) {
      // Each format with one of the clocks, in a long run with both.
      if (!isLongRun() && (std::string(clock) == "real") != name.ends_with(".vdb")) continue;
      const Words save = {"--journal", fmt::format("journal-{}-{}", clock, name), "--save", name, "--save-every",
                          "0.2"};
      const Outcome touched = run(touch(kDrill + save, clock));
      expectSuccess(touched);
      EXPECT_THAT(touched.out, HasSubstr("in " + name + " up to edit"));
      const auto edits = summary()["edits"];
      EXPECT_GE(edits["saves"], 1);
      EXPECT_EQ(edits["save_version"], edits["count"]);
      EXPECT_EQ(edits["save_bytes"], std::filesystem::file_size(file(name)));
      EXPECT_EQ(edits["save_s"]["count"], edits["saves"]);
      EXPECT_EQ(edits["save_failures"], 0);
      const Outcome recovered = run({"recover", save[1], "--out", "back.vdb"});
      expectSuccess(recovered);
      EXPECT_EQ(contentIn(recovered.out), contentOf(file(name))) << clock << " " << name;
    }
  }
}

// The picture and the report are those of a run without saves, to the byte where no time is in them.
TEST_F(LiveEdits, SavingChangesNothingElse) {
  Words words = touch(kDrill + Words{"--width", "480", "--height", "270"});
  words[7] = "on";
  expectSuccess(run(words));
  const std::string picture = contentsOf(file("out") / "view.png"), trace = contentsOf(file("out") / "trace.csv");
  expectSuccess(run(words + Words{"--save", "sculpted.vdb", "--save-every", "0.1"}));
  EXPECT_EQ(contentsOf(file("out") / "view.png"), picture);
  EXPECT_EQ(contentsOf(file("out") / "trace.csv"), trace);
}

TEST_F(LiveEdits, RefusesSavesThatCannotBeMeant) {
  expectRefusal(run(touch({"--save", "a.vdb"})), "--save a.vdb", "nothing is edited", 2);
  expectRefusal(run(touch(kDrill + Words{"--save-every", "2"})), "--save-every 2", "no file to save", 2);
  expectRefusal(run(touch(kDrill + Words{"--save", "a.tiff"})), "--save a.tiff", "names no format", 2);
  expectRefusal(run(touch(kDrill + Words{"--save", "no/a.vdb"})), "no/a.vdb", "No such file or directory", 4);
  expectSuccess(run({"convert", kVolume, "start.vdb"}));
  Words words = touch(kDrill + Words{"--save", "start.vdb"});
  words[1] = "start.vdb";
  expectRefusal(run(words), "start.vdb", "it is the input", 2);
  EXPECT_FALSE(exists("a.vdb"));
  EXPECT_FALSE(exists("out"));
}

TEST_F(LiveEdits, AGpuBudgetThatIsTooSmallIsRefusedBeforeTheRun) {
  expectRefusal(run(touch(kDrill + Words{"--gpu-memory", "100KiB"})), "GPU memory for", "the budget is 0.1 MiB", 5);
  expectRefusal(run(touch({"--gpu-memory", "much"})), "--gpu-memory", "'much' is no size", 2);
  EXPECT_FALSE(exists("out"));
}

// A tool that adds, in a budget that does not hold what it adds: what does not fit is refused and told once, all else
// goes on, and journal and file agree. The 96^3 sphere and the room for 256 more bricks that is made beforehand take
// 8.9 MiB (a brick: 2 KiB of density, 8 KiB of gradients); balls of 20 mm all around it need more than 9 MiB.
TEST_F(LiveEdits, AnEditBeyondTheGpuBudgetIsRefusedAndTheSessionGoesOn) {
  const Words words = {"touch",        "phantom:sphere?size=96",
                       "--seconds",    "3",
                       "--clock",      "simulated",
                       "--picture",    "off",
                       "--out",        "out",
                       "--edit",       "add:radius=20mm:period=40",
                       "--slide",      "250",
                       "--gpu-memory", "9MiB",
                       "--journal",    "journal",
                       "--save",       "sculpted.vdb"};
  const Outcome outcome = run(words);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const Words lines = errorLines(outcome.err);
  ASSERT_GE(lines.size(), 1U) << outcome.out;
  EXPECT_LE(lines.size(), 2U) << outcome.err;  // of densities, and of gradients
  EXPECT_THAT(lines[0], HasSubstr("an edit was refused: GPU memory for"));
  EXPECT_THAT(lines[0], HasSubstr("raise --gpu-memory"));
  const auto edits = summary()["edits"];
  EXPECT_GT(edits["refused"], 0);
  EXPECT_GT(edits["count"], 0);
  EXPECT_EQ(edits["journal_saved"], edits["count"]);
  EXPECT_EQ(edits["save_version"], edits["count"]);
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  expectSuccess(recovered);
  EXPECT_EQ(contentIn(recovered.out), contentOf(file("sculpted.vdb")));
}

}  // namespace live_edits_test
}  // namespace palpate
