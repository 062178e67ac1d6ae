// SPDX-License-Identifier: Apache-2.0
// A run that fails in the middle: what its tool edited is saved, and the error says so. The run as a user has it:
// tests/apps/palpate/live_edits_test.cpp.
#include "apps/touch/live_edits.hpp"

#include <fstream>
#include <new>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "engine/journal/journal_reader.hpp"
#include "engine/journal/volume_identity.hpp"
#include "temporary_folder.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace live_edits_test {

using ::testing::HasSubstr;

class FailingRun : public testing::Test {
 protected:
  FailingRun() {
    scene.edit = "remove:radius=2mm";
    scene.journal = journal.string();
    scene.save = file.string();
    scene.isovalue = defaultIsovalue(volume);
  }
  // `looks` at a tool that sinks in from the sphere's outside, a period each, and then `failure`.
  template <typename Failure>
  void run(int looks, const Failure& failure) {
    Engine engine(volume, makePlan({}), *scene.isovalue, "");
    LiveEdits edits(scene, volume, engine);
    edits.during([&] {
      for (int i = 0; i < looks; ++i) {
        ToolPose pose;
        pose.tick = 0;
        pose.normal_W = Vec3::UnitX();
        pose.position_W = volume.lattice().toWorld(Vec3(28 - 2 * i, 16, 16));
        edits.edits().look(pose, i * std::int64_t{10'000'000});
      }
      throw failure;
    });
  }

  TemporaryFolder folder;
  std::filesystem::path journal = folder.path() / "journal", file = folder.path() / "sculpted.vdb";
  Volume volume = loadVolume("phantom:sphere?size=32");
  Scene scene;
};

TEST_F(FailingRun, SavesWhatWasEditedAndSaysSo) {
  const std::uint64_t before = contentHash(volume);
  try {
    run(6, Error(Error::Code::kDevice, "GPU", "it is lost", "start again"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kDevice);
    EXPECT_THAT(error.what(), HasSubstr("GPU: it is lost; start again; no report was written, but "));
    EXPECT_THAT(error.what(), HasSubstr(scene.save + " holds the volume up to edit 5 of 5"));
    EXPECT_THAT(error.what(), HasSubstr("the journal " + scene.journal + " holds edits up to number 5"));
  }
  EXPECT_EQ(readJournal(journal).last_sequence, 5U);
  EXPECT_NE(contentHash(volume), before);
  EXPECT_EQ(contentHash(loadVolume(scene.save)), contentHash(volume));
}

// A path file that says where the tool edits: its first brush stands for --edit, and both are too many.
TEST(RecordedBrush, StandsForTheOption) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "way.csv";
  const auto write = [&](const std::string& brush) {
    std::ofstream(file) << "time_s,x_m,y_m,z_m,brush\n0,0,0,0,\n1,0,0,0," << brush << "\n";
  };
  Scene scene;
  scene.path_file = file.string();
  write("");
  EXPECT_EQ(withRecordedBrush(scene).edit, "");
  write("remove:radius=2mm");
  EXPECT_EQ(withRecordedBrush(scene).edit, "remove:radius=2mm");
  scene.edit = "add:radius=1mm";
  EXPECT_THAT(refusalOf([&] { (void)withRecordedBrush(scene); }, Error::Code::kBadInput),
              HasSubstr("leave --edit out"));
  scene.edit.clear();
  write("remove:radius=2parsec");
  EXPECT_THAT(refusalOf([&] { (void)withRecordedBrush(scene); }, Error::Code::kBadInput),
              testing::AllOf(HasSubstr("way.csv, 1 s after"), HasSubstr("parsec")));
}

TEST_F(FailingRun, SavesAfterOtherExceptionsToo) {
  EXPECT_THROW(run(6, std::bad_alloc()), std::bad_alloc);
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(FailingRun, WithoutAnEditLeavesNoJournal) {
  scene.save.clear();
  EXPECT_EQ(
      refusalOf([&] { run(0, Error(Error::Code::kDevice, "GPU", "it is lost", "start again")); }, Error::Code::kDevice),
      "GPU: it is lost; start again; nothing was written; start it again");
  EXPECT_FALSE(std::filesystem::exists(journalFile(journal)));
}

// A run that its user ended before the tool touched anything: the journal is deleted, and the figures know of none.
TEST_F(FailingRun, ThatIsEndedEarlyDropsAnEmptyJournalAlone) {
  scene.save.clear();
  for (const int looks : {0, 6}) {
    Engine engine(volume, makePlan({}), *scene.isovalue, "");
    LiveEdits edits(scene, volume, engine);
    for (int i = 0; i < looks; ++i) {
      ToolPose pose;
      pose.tick = 0;
      pose.normal_W = Vec3::UnitX();
      pose.position_W = volume.lattice().toWorld(Vec3(28 - 2 * i, 16, 16));
      edits.edits().look(pose, i * std::int64_t{10'000'000});
    }
    std::vector<std::string> notes;
    RunEdits run = edits.finish(notes);
    edits.dropEmptyJournal(run);
    EXPECT_EQ(std::filesystem::exists(journalFile(journal)), looks > 0);
    EXPECT_EQ(run.journal_bytes, looks > 0 ? std::filesystem::file_size(journalFile(journal)) : 0);
    EXPECT_TRUE(notes.empty());
  }
}

TEST_F(FailingRun, NotesThatItsBrushIsFine) {
  scene.edit = "remove:radius=1um";
  Engine engine(volume, makePlan({}), *scene.isovalue, "");
  LiveEdits edits(scene, volume, engine);
  std::vector<std::string> notes;
  static_cast<void>(edits.finish(notes));
  EXPECT_THAT(notes, testing::ElementsAre(testing::StartsWith("--edit remove:radius=1um: its radius of 0.001 mm is")));
}

TEST(KeptEdits, AreNamedWhereTheyAre) {
  Scene scene;
  scene.save = "a.vdb";
  scene.journal = "kept";
  RunEdits edits;
  edits.count = 5;
  EXPECT_EQ(keptEdits(scene, edits), "");
  edits.journal_saved = 3;
  EXPECT_EQ(keptEdits(scene, edits), "the journal kept holds edits up to number 3: see 'palpate recover'");
  edits.save_version = 4;
  EXPECT_EQ(
      keptEdits(scene, edits),
      "a.vdb holds the volume up to edit 4 of 5, the journal kept holds edits up to number 3: see 'palpate recover'");
  edits.save_failure = "it is full";
  EXPECT_EQ(keptEdits(scene, edits),
            "a.vdb holds the volume up to edit 4 of 5, the journal kept holds edits up to number 3: "
            "see 'palpate recover', a.vdb was not written anew (it is full)");
  edits = {};
  edits.save_failure = "it is full";
  EXPECT_EQ(keptEdits(scene, edits), "a.vdb was not written anew (it is full)");
  scene.save = "";
  EXPECT_EQ(keptEdits(scene, edits), "");
}

TEST(KeptEdits, AreLostWhereTheirFileOrTheirJournalFailed) {
  RunEdits edits;
  EXPECT_FALSE(lostEdits(edits));
  edits.save_failure = "full";
  EXPECT_TRUE(lostEdits(edits));
  edits.save_failure = "";
  edits.journal_failure = "full";
  EXPECT_TRUE(lostEdits(edits));
}

// No two figures are equal, so none can stand in another's place.
TEST(RunEdits, AreTheSessionsFiguresInMilliseconds) {
  EditFigures figures;
  figures.edits = 9;
  figures.windows = 2;
  figures.edit_to_window_s = {0.25, 2};
  figures.journalled = 8;
  figures.acknowledged = 7;
  figures.journal_bytes = 600;
  figures.journal_failure = "the journal's disk is full";
  figures.saves.saves = 12;
  figures.saves.seconds = {1, 5, 3};
  figures.saves.failures = 4;
  figures.saves.bytes = 1000;
  figures.saves.version = 6;
  figures.saves.failure = "the file's disk is full";
  const RunEdits edits = runEdits(figures, 10);
  EXPECT_EQ(edits.count, 9U);
  EXPECT_EQ(edits.published, 2U);
  EXPECT_EQ(edits.edit_to_window_ms, (std::vector<double>{250, 2000}));
  EXPECT_EQ(edits.journal_records, 8U);
  EXPECT_EQ(edits.journal_saved, 7U);
  EXPECT_EQ(edits.journal_bytes, 600U);
  EXPECT_EQ(edits.journal_failure, "the journal's disk is full");
  EXPECT_EQ(edits.refused, 10U);
  EXPECT_EQ(edits.saves, 12U);
  EXPECT_EQ(edits.save_failures, 4U);
  EXPECT_EQ(edits.save_bytes, 1000U);
  EXPECT_EQ(edits.save_version, 6U);
  EXPECT_EQ(edits.save_s, (std::vector<double>{1, 5, 3}));
  EXPECT_EQ(edits.save_failure, "the file's disk is full");
}

// Of a run that ends well: what was edited and refused is counted, and each refusal is a note.
TEST_F(FailingRun, ThatEndsWellCountsWhatItDid) {
  Engine engine(volume, makePlan({}), *scene.isovalue, "");
  LiveEdits edits(scene, volume, engine);
  EditCommand bad = toolBrushSpec(scene.edit).brush;
  bad.radius_m = -1;
  edits.edits().edit({bad});
  ToolPose pose;
  pose.tick = 0;
  pose.normal_W = Vec3::UnitX();
  for (int i = 0; i < 6; ++i) {
    pose.position_W = volume.lattice().toWorld(Vec3(28 - 2 * i, 16, 16));
    edits.edits().look(pose, i * std::int64_t{10'000'000});
  }
  std::vector<std::string> notes = {"a note"};
  const RunEdits run = edits.finish(notes);
  EXPECT_EQ(run.count, 5U);  // the first look begins the first period
  EXPECT_EQ(run.refused, 1U);
  EXPECT_EQ(run.published, run.edit_to_window_ms.size());
  EXPECT_EQ(run.journal_records, 5U);
  EXPECT_EQ(run.journal_saved, 5U);
  EXPECT_EQ(run.saves, 1U);
  EXPECT_EQ(run.save_version, 5U);
  EXPECT_THAT(notes, testing::ElementsAre("a note", testing::StartsWith("an edit was refused: ")));
}

TEST(EditOptions, ThatGoTogetherOnlyAreRefusedApart) {
  TemporaryFolder folder;
  Scene scene;
  const auto refusal = [&](Error::Code code = Error::Code::kBadInput) {
    return refusalOf([&] { checkEditOptions(scene); }, code);
  };
  EXPECT_EQ(refusal(), kNoRefusal);
  scene.journal = "kept";
  EXPECT_EQ(
      refusal(),
      "--journal kept: nothing is edited; give a brush, for example --edit remove:radius=2mm, or leave --journal out");
  scene.edit = "remove:radius=2mm";
  EXPECT_EQ(refusal(), kNoRefusal);
  scene.save_every_s = 3;
  EXPECT_EQ(
      refusal(),
      "--save-every 3: there is no file to save; name one, for example --save sculpted.vdb, or leave --save-every out");
  scene.save = "a.docx";
  EXPECT_THAT(refusal(),
              testing::StartsWith("--save a.docx: its suffix names no format that volumes are written in; use"));
  scene.save = (folder.path() / "a.vdb").string();
  EXPECT_EQ(refusal(), kNoRefusal);
  EXPECT_EQ(folder.files(), 0);
  scene.save = (folder.path() / "none" / "a.vdb").string();
  EXPECT_NE(refusal(Error::Code::kIo), kNoRefusal);
  scene.save = (folder.path() / "in.vdb").string();
  std::ofstream(scene.save) << "a volume";
  scene.volume = scene.save;
  EXPECT_THAT(refusal(), HasSubstr("it is the input"));
  scene.save = "";
  scene.save_every_s = 0;
  scene.algorithm = "god-object";
  EXPECT_EQ(refusal(),
            "--edit remove:radius=2mm: "
            "god-object feels a mesh that is made once, before the run; choose another --algorithm, for example hri");
  scene.edit = "remove";
  EXPECT_NE(refusal(), kNoRefusal);
}

// A brush with which every edit would be refused is refused before the run.
TEST_F(FailingRun, DoesNotBeginWithAFaintFilling) {
  scene.edit = "add:radius=2mm:density=-5000";
  Engine engine(volume, makePlan({}), *scene.isovalue, "");
  try {
    const LiveEdits edits(scene, volume, engine);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("--edit add:radius=2mm:density=-5000: its object density of -5000 is not above"));
  }
  EXPECT_FALSE(std::filesystem::exists(journalFile(journal)));
}

// What fails between the set-up and the servo finds nothing to save.
TEST_F(FailingRun, BeforeItBeginsLeavesNothing) {
  {
    Engine engine(volume, makePlan({}), *scene.isovalue, "");
    const LiveEdits edits(scene, volume, engine);
    EXPECT_TRUE(std::filesystem::exists(journalFile(journal)));
  }
  EXPECT_FALSE(std::filesystem::exists(journalFile(journal)));
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace live_edits_test
}  // namespace palpate
