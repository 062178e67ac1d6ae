// SPDX-License-Identifier: Apache-2.0
// Volumes that are opened by name or dropped into the window, files that cannot be read or written, and work that no
// file holds yet.
#include <chrono>
#include <thread>

#include "apps/sculpt/session_folders.hpp"
#include "base/error.hpp"
#include "engine/journal/volume_identity.hpp"
#include "sculpt_window.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/small_disk.hpp"

namespace palpate {
namespace window_files_test {

// One that is not there leaves what is open; another takes its place.
TEST_F(OnADesktop, OpensAnotherVolume) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  enters(kFileX, kOpenY, "/nowhere/none.vdb");
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kMessage) > 50; }));
  ASSERT_TRUE(movesOff());
  EXPECT_EQ(differing(before, desktop->look(), kUpper), 0);
  EXPECT_FALSE(journal().empty());
  enters(kFileX, kOpenY, "phantom:box?size=32");
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 1000 && !journal().empty(); }));
  ASSERT_TRUE(movesOff());
  EXPECT_GT(ballPixels(desktop->look()), 1000);
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));
  EXPECT_THAT(settings(), testing::AllOf(testing::HasSubstr("phantom:box?size=32"), testing::HasSubstr(kBall)));
}

// Another volume is asked for with edits that no file holds: "Go on" leaves all as it was, a file that cannot be
// written too, and "keep the journal" opens the other and keeps the edits for the next start.
TEST_F(OnADesktop, AsksBeforeItLeavesUnsavedWork) {
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  ASSERT_TRUE(drills());
  const Screen drilled = desktop->look();
  const Rectangle question{440, 310, 400, 100};
  const auto asks = [&] {
    enters(kFileX, kOpenY, "phantom:box?size=32");
    return waitUntil([&] { return differing(drilled, desktop->look(), question) > 10000; });
  };
  const auto is_as_before = [&] {
    return movesOff() && waitUntil([&] { return differing(drilled, desktop->look(), kUpper) == 0; });
  };
  ASSERT_TRUE(asks());
  desktop->does({"key", "Escape"});
  EXPECT_TRUE(is_as_before());

  desktop->does({"mousemove", std::to_string(kFileX), std::to_string(kSaveY), "click", "1"});
  desktop->does({"type", "--delay", "20", "a.bad"});
  ASSERT_TRUE(asks());
  desktop->does({"mousemove", "520", "390", "click", "1"});  // "Save a.bad"
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kMessage) > 50; }));
  EXPECT_TRUE(is_as_before());
  const std::filesystem::path kept = journal();
  ASSERT_FALSE(kept.empty());

  ASSERT_TRUE(asks());
  desktop->does({"mousemove", "660", "390", "click", "1"});  // "Open, keep the journal"
  EXPECT_TRUE(waitUntil([&] { return leftSessions(journals()).size() == 1; }));
  EXPECT_EQ(leftSessions(journals()).at(0).folder, kept);
  EXPECT_TRUE(waitUntil([&] { return differing(drilled, desktop->look(), kUpper) > 1000; }));
  ASSERT_TRUE(showsBall()) << program->said();  // the box: until then it is loaded
  endsWell();
  EXPECT_EQ(journal(), kept);
  EXPECT_NE(contentHash(replayed(kept)), contentHash(loadVolume(kBall)));
}

// One that is damaged leaves what is open, and is named; the first of several good ones takes its place.
TEST_F(OnADesktop, OpensWhatIsDropped) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  const Screen before = desktop->look();
  const std::filesystem::path damaged = folder.path() / "damaged.nrrd", good = folder.path() / "a box.nrrd";
  std::ofstream(damaged) << "NRRD0004\ntype: float\n";
  desktop->drops({damaged});
  EXPECT_TRUE(saysSomething(before)) << program->said();
  ASSERT_TRUE(movesOff());
  EXPECT_EQ(differing(before, desktop->look(), kUpper), 0);
  EXPECT_FALSE(journal().empty());

  saveVolume(loadVolume("phantom:box?size=32"), good);
  desktop->drops({good, damaged});
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kUpper) > 1000 && !journal().empty(); }));
  ASSERT_TRUE(movesOff());
  EXPECT_GT(ballPixels(desktop->look()), 1000);
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));
  EXPECT_THAT(settings(),
              testing::AllOf(testing::HasSubstr(good.string()), testing::Not(testing::HasSubstr("damaged"))));
}

// What cannot be written is said, is still unsaved, and can be written elsewhere. DrillsUndoesAndSaves
// (sculpt_window_test.cpp) sees the same on its way.
TEST_F(OnADesktop, SaysThatAFileCannotBeWritten) {
  PALPATE_LONG_ONLY();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  ASSERT_TRUE(drills());
  const Screen before = desktop->look();
  enters(kFileX, kSaveY, "/nowhere/a.vdb");
  EXPECT_TRUE(waitUntil([&] { return differing(before, desktop->look(), kMessage) > 50; }));
  const std::string file = (folder.path() / "b.vdb").string();
  enters(kFileX, kSaveY, file);
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said();
  EXPECT_EQ(contentHash(loadVolume(file)), contentHash(replayed(journal())));
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(journals()));
}

// The volume's values are larger than the disk.
TEST_F(OnADesktop, SaysThatADiskIsFull) {
  PALPATE_LONG_ONLY();
  const SmallDisk disk(folder.path() / "disk");
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  ASSERT_TRUE(drills());
  const Screen before = desktop->look();
  enters(kFileX, kSaveY, (folder.path() / "disk/a.nrrd").string());
  EXPECT_TRUE(saysSomething(before)) << program->said();
  endsWell();
  EXPECT_TRUE(std::filesystem::is_empty(folder.path() / "disk"));
  const std::vector<LeftSession> left = leftSessions(journals());  // not saved: still in the journal
  ASSERT_EQ(left.size(), 1U);
  EXPECT_GT(left[0].edits, 0U);
  EXPECT_EQ(left[0].damage, "");
}

// The journal can take no more. The session goes on and says so, and a file takes all of it.
TEST_F(OnADesktop, GoesOnWithoutItsJournal) {
  PALPATE_LONG_ONLY();
  const SmallDisk disk(home() / ".local/state");
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  disk.fill();
  const Screen before = desktop->look();
  ASSERT_TRUE(drills());
  EXPECT_TRUE(saysSomething(before)) << program->said();
  const Screen drilled = desktop->look();
  EXPECT_GT(differing(before, drilled, {kMiddleX - 60, kMiddleY - 60, 200, 120}), 100);
  const std::string file = (folder.path() / "b.vdb").string();
  enters(kFileX, kSaveY, file);
  ASSERT_TRUE(waitUntil([&] { return std::filesystem::exists(file); })) << program->said();
  EXPECT_NE(contentHash(loadVolume(file)), contentHash(loadVolume(kBall)));
  ASSERT_TRUE(program->runs()) << program->said();
  program->signals(SIGTERM);
  EXPECT_EQ(program->ends(), 0) << program->said();  // nothing is lost
}

// And where no file takes it, the program says at its end that something is lost.
TEST_F(OnADesktop, EndsWithAnErrorWhereItsJournalLostEdits) {
  PALPATE_LONG_ONLY();
  const SmallDisk disk(home() / ".local/state");
  if (!disk) GTEST_SKIP() << SmallDisk::whyNot();
  start();
  ASSERT_TRUE(showsBall()) << program->said();
  disk.fill();
  ASSERT_TRUE(drills());
  program->signals(SIGTERM);
  EXPECT_EQ(program->ends(), exitStatus(Error::Code::kIo)) << program->said();
  EXPECT_THAT(program->said(), testing::HasSubstr("journal"));
}

}  // namespace window_files_test
}  // namespace palpate
