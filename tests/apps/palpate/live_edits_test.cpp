// SPDX-License-Identifier: Apache-2.0
// palpate touch --edit, --journal and palpate recover, as a user gives them.
#include <nlohmann/json.hpp>

#include "engine/journal/journal_reader.hpp"
#include "program_test.hpp"
#include "trace.hpp"

namespace palpate {
namespace {

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
  EXPECT_FALSE(exists("back.vdb.part"));
  expectRefusal(run(touch(kDrill + Words{"--journal", "journal"})), "journal", "another session", 2);
}

TEST_F(LiveEdits, RecoverSaysWhatADamagedTailLost) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  std::string bytes = contentsOf(journalFile(file("journal")));
  write("journal/journal.palpate", bytes.substr(0, bytes.size() - 5));
  const Outcome recovered = run({"recover", "journal", "--out", "back.vdb"});
  expectSuccess(recovered);
  EXPECT_THAT(recovered.out, HasSubstr("Lost      1 record in"));
  EXPECT_THAT(recovered.out, HasSubstr("is cut short"));
}

TEST_F(LiveEdits, RecoverRefusesWhatItCannotRecover) {
  expectSuccess(run(touch(kDrill + Words{"--journal", "journal"})));
  expectRefusal(run({"recover", "journal", "--out", "back.vdb", "--volume", "phantom:sphere?size=40"}), "size=40",
                "not the volume that the journal began with", 2);
  expectRefusal(run({"recover", "journal", "--out", "back.nii"}), "back.nii", "does not end in .vdb", 2);
  expectRefusal(run({"recover", "nothing", "--out", "back.vdb"}), "nothing", "no journal.palpate", 3);
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

}  // namespace
}  // namespace palpate
