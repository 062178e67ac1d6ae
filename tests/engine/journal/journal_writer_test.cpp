// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/journal_writer.hpp"

#include <cerrno>
#include <numeric>
#include <system_error>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/journal/journal_reader.hpp"
#include "journal_samples.hpp"
#include "tests/support/few_descriptors.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/without_call.hpp"

namespace palpate {
namespace journal_writer_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const JournalHeader& header() {
  static const JournalHeader kHeader = sampleHeader(sampleVolume());
  return kHeader;
}

TEST(JournalWriter, WhatIsAppendedIsReadInOrder) {
  TemporaryFolder folder;
  JournalWriter writer(folder.path() / "a" / "b", header());
  const std::vector<EditCommand> two = {dab(1e-3), dab(2e-3)};
  EXPECT_EQ(writer.edit(two), 1U);
  EXPECT_EQ(writer.undo(), 2U);
  EXPECT_EQ(writer.redo(), 3U);
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 3U);
  const Journal journal = readJournal(folder.path() / "a" / "b");
  EXPECT_FALSE(journal.damage);
  ASSERT_EQ(journal.records.size(), 3U);
  ASSERT_EQ(journal.records[0].commands.size(), 2U);
  EXPECT_EQ(journal.records[0].commands[1].from_W.x(), 2e-3);
  EXPECT_EQ(journal.records[1].kind, RecordKind::kUndo);
  EXPECT_EQ(journal.records[2].kind, RecordKind::kRedo);
  EXPECT_EQ(writer.bytes(), bytesOf(folder.path() / "a" / "b").size());
}

TEST(JournalWriter, AStampIsWrittenOnce) {
  TemporaryFolder folder;
  EditCommand command;
  command.kind = EditKind::kStampAdd;
  command.stamp = RandomEdits::ball(2e-3);
  JournalWriter writer(folder.path(), header());
  EXPECT_EQ(writer.edit({&command, 1}), 2U);
  EXPECT_EQ(writer.edit({&command, 1}), 3U);
  EXPECT_EQ(command.stamp.use_count(), 1) << "the journal keeps it";
  EditCommand again = command;
  again.stamp = RandomEdits::ball(2e-3);  // made anew, the same
  EXPECT_EQ(writer.edit({&again, 1}), 4U);
  again.stamp = RandomEdits::ball(3e-3);
  EXPECT_EQ(writer.edit({&again, 1}), 6U);
  writer.close();
  const Journal journal = readJournal(folder.path());
  ASSERT_EQ(journal.records.size(), 4U);
  EXPECT_NE(journal.records[0].commands[0].stamp, journal.records[3].commands[0].stamp);
  EXPECT_EQ(journal.records[0].commands[0].stamp, journal.records[1].commands[0].stamp);
  EXPECT_EQ(journal.records[0].commands[0].stamp->distance_m, command.stamp->distance_m);
}

// When a number is acknowledged, the file holds the record: looked at in that very moment, by the journal's thread.
TEST(JournalWriter, AcknowledgesOnlyWhatIsInTheFile) {
  TemporaryFolder folder;
  std::vector<std::uint64_t> acknowledged;
  std::uint64_t missing = 0;
  JournalOptions options;
  options.gather = std::chrono::microseconds(100);
  options.on_acknowledged = [&](std::uint64_t newest) {
    acknowledged.push_back(newest);
    if (readJournal(folder.path()).last_sequence < newest) ++missing;
  };
  JournalWriter writer(folder.path(), header(), options);
  for (int i = 0; i < 200; ++i) {
    const EditCommand command = dab(i * 1e-3);
    writer.edit({&command, 1});
    if (i % 20 == 0) writer.flush();
  }
  writer.close();
  EXPECT_EQ(missing, 0U);
  EXPECT_GE(acknowledged.size(), 10U);
  EXPECT_TRUE(std::is_sorted(acknowledged.begin(), acknowledged.end()));
  EXPECT_EQ(acknowledged.back(), 200U);
}

// A million at once through a queue of 64 KiB: whoever queues waits, and everything arrives.
TEST(JournalWriter, AMillionCommandsWaitTheirTurn) {
  TemporaryFolder folder;
  JournalOptions options;
  options.queue_bytes = 65536;
  JournalWriter writer(folder.path(), header(), options);
  constexpr std::uint64_t kMany = 1'000'000;
  constexpr std::uint64_t kDabBytes = kRecordFrame + 4 + 2 + std::size_t{9} * 8;  // count; kind, flags; 9 numbers
  std::vector<EditCommand> commands(1, dab(0));
  for (std::uint64_t i = 1; i <= kMany; ++i) {
    commands[0].radius_m = static_cast<double>(i);
    ASSERT_EQ(writer.edit(commands), i);
    // Never is more on its way than the queue and the group that is being written hold.
    ASSERT_LE((i - writer.acknowledged()) * kDabBytes, 2 * options.queue_bytes);
  }
  writer.close();
  EXPECT_EQ(writer.acknowledged(), kMany);
  EXPECT_EQ(writer.failure(), "");
  const Journal journal = readJournal(folder.path());
  ASSERT_EQ(journal.records.size(), kMany);
  for (std::uint64_t i = 0; i < kMany; ++i) {
    ASSERT_EQ(journal.records[i].commands[0].radius_m, static_cast<double>(i + 1));
  }
}

TEST(JournalWriter, ARecordLargerThanTheQueueGoesThrough) {
  TemporaryFolder folder;
  JournalOptions options;
  options.queue_bytes = 10;
  JournalWriter writer(folder.path(), header(), options);
  const EditCommand command = dab(0);
  for (int i = 0; i < 5; ++i) writer.edit({&command, 1});
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 5U);
}

// Whoever waits for the disk does not wait for others to come: a flush, a full queue, the end. With an hour to gather
// this test would not end otherwise.
TEST(JournalWriter, GathersNoLongerWhereSomebodyWaits) {
  const TemporaryFolder folder;
  JournalOptions options;
  options.gather = std::chrono::hours(1);
  options.queue_bytes = 250;
  JournalWriter writer(folder.path(), header(), options);
  constexpr std::uint64_t kDabBytes = kRecordFrame + 4 + 2 + std::size_t{9} * 8;  // count; kind, flags; 9 numbers
  const EditCommand command = dab(0);
  writer.edit({&command, 1});
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 1U);
  for (int i = 0; i < 20; ++i) writer.edit({&command, 1});  // two fit into the queue
  writer.flush();
  EXPECT_EQ(writer.appended(), 21U);
  EXPECT_EQ(writer.acknowledged(), 21U);
  EXPECT_EQ(writer.bytes(), headerBytes(header()).size() + 21 * kDabBytes);
  writer.undo();
  writer.close();
  EXPECT_EQ(readJournal(folder.path()).last_sequence, 22U);
}

// A stamp that a command has and does not use is no record.
TEST(JournalWriter, WritesOnlyStampsThatAreUsed) {
  const TemporaryFolder folder;
  JournalWriter writer(folder.path(), header());
  EditCommand command = dab(0);
  command.stamp = RandomEdits::ball(2e-3);
  EXPECT_EQ(writer.edit({&command, 1}), 1U);
  writer.close();
  EXPECT_EQ(readJournal(folder.path()).records.at(0).commands.at(0).stamp, nullptr);
}

// The journal ends, the session does not; the file holds whole records only, no fewer than were acknowledged and no
// more than that either, so that nothing half-written looks saved.
TEST(JournalWriter, AFullDiskEndsTheJournalAndNothingElse) {
  TemporaryFolder folder;
  JournalWriter writer(folder.path(), header());
  const EditCommand command = dab(0);
  for (int i = 0; i < 10; ++i) writer.edit({&command, 1});
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 10U);
  EXPECT_FALSE(writer.failed());
  {
    const FileSizeLimit limit(writer.bytes() + 150);  // one record and a piece
    for (int i = 0; i < 5000; ++i) writer.edit({&command, 1});
    writer.flush();
    EXPECT_TRUE(writer.failed());
    EXPECT_THAT(writer.failure(), HasSubstr("edits after number 10 (record 10 of the journal) are not saved"));
    EXPECT_THAT(writer.failure(), HasSubstr("make room"));
  }
  EXPECT_EQ(writer.edit({&command, 1}), 5011U);  // goes on, unsaved
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 10U);
  writer.close();
  const Journal journal = readJournal(folder.path());
  EXPECT_FALSE(journal.damage);
  EXPECT_EQ(journal.last_sequence, 10U);
}

// As many commands as an edit may have, of the longest kind: their record is one that a reader takes.
TEST(JournalWriter, TheLargestEditComesBack) {
  TemporaryFolder folder;
  EditCommand command;
  command.kind = EditKind::kStampAdd;
  command.stamp = RandomEdits::ball(2e-3);
  command.object = 1;
  command.material.emplace();
  const std::vector<EditCommand> commands(kMaxCommands, command);
  JournalWriter writer(folder.path(), header());
  EXPECT_EQ(writer.edit(commands), 2U);
  writer.close();
  const Journal journal = readJournal(folder.path());
  EXPECT_FALSE(journal.damage);
  ASSERT_EQ(journal.records.size(), 1U);
  EXPECT_EQ(journal.records[0].commands.size(), kMaxCommands);
}

// Edits are counted as the engine counts them, so that one number can be held against what a save says; stamps are
// records beside.
TEST(JournalWriter, AFailureNamesTheLastEditAndItsRecord) {
  TemporaryFolder folder;
  JournalWriter writer(folder.path(), header());
  EditCommand command;
  command.kind = EditKind::kStampAdd;
  command.stamp = RandomEdits::ball(2e-3);
  writer.edit({&command, 1});
  writer.undo();
  writer.redo();
  writer.flush();
  const FileSizeLimit limit(writer.bytes() + 10);
  writer.edit({&command, 1});
  writer.flush();
  EXPECT_EQ(writer.acknowledged(), 4U);
  EXPECT_THAT(writer.failure(), HasSubstr("edits after number 3 (record 4 of the journal) are not saved: make room"));
}

// What has nothing in it is in the way of the same command, given again when there is room.
TEST(JournalWriter, ADiskThatWasFullFromTheStartLeavesNoJournal) {
  for (const bool drop : {false, true}) {
    TemporaryFolder folder;
    JournalWriter writer(folder.path(), header());
    {
      const FileSizeLimit limit(writer.bytes() + 10);
      writer.edit({{dab(0)}});
      writer.flush();
    }
    EXPECT_THAT(writer.failure(), HasSubstr("; edits after number 0 are not saved: make room"));
    if (drop) writer.closeAndDropEmpty();
    writer.close();
    EXPECT_EQ(folder.files(), 0);
    const JournalWriter again(folder.path(), header());
    writer.closeAndDropEmpty();
    EXPECT_EQ(folder.files(), 1) << "it removed another session's";
  }
}

// The folder above is flushed only where it got a new entry, and for that it must be opened: no file more may be.
TEST(JournalWriter, BringsNewFoldersToTheDisk) {
  TemporaryFolder folder;
  const std::filesystem::path place = folder.path() / "new" / "deep";
  std::string input;
  try {
    const FewDescriptors none;
    JournalWriter writer(place, header());
  } catch (const Error& error) {
    input = error.input();
  }
  EXPECT_EQ(input, place) << "it was the file that could not be opened";
}

TEST(JournalWriter, AFullDiskAtTheStartIsAnError) {
  TemporaryFolder folder;
  const FileSizeLimit limit(20);
  try {
    JournalWriter writer(folder.path(), header());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_THAT(error.what(), HasSubstr("make room"));
  }
  EXPECT_EQ(folder.files(), 0);
}

// One file more may be open: the journal, and not its folder, so that this cannot be flushed.
TEST(JournalWriter, WhatIsRefusedLeavesNoJournal) {
  TemporaryFolder folder;
  {
    const FewDescriptors one_more(1);
    EXPECT_THROW(JournalWriter(folder.path(), header()), Error);
  }
  EXPECT_EQ(folder.files(), 0);
}

TEST(JournalWriter, DropsTheFileWhereNothingWasAppended) {
  TemporaryFolder empty, used;
  JournalWriter first(empty.path(), header()), second(used.path(), header());
  second.edit({{dab(0)}});
  first.closeAndDropEmpty();
  second.closeAndDropEmpty();
  EXPECT_EQ(empty.files(), 0);
  EXPECT_EQ(first.bytes(), 0U);
  EXPECT_EQ(used.files(), 1);
  EXPECT_GT(second.bytes(), 0U);
}

TEST(JournalWriter, RefusesAFolderThatHoldsAJournal) {
  TemporaryFolder folder;
  { const JournalWriter first(folder.path(), header()); }
  const std::string before = bytesOf(folder.path());
  try {
    JournalWriter second(folder.path(), header());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("palpate recover"));
  }
  EXPECT_EQ(bytesOf(folder.path()), before);
  EXPECT_EQ(folder.files(), 1);
}

TEST(JournalWriter, RefusesAPlaceThatIsNoFolder) {
  TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  try {
    const JournalWriter writer(folder.path() / "file", header());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_THAT(error.what(), HasSubstr("no journal can be kept there ("));
    EXPECT_EQ(error.remedy(), "make room or choose another folder with --journal");
  }
  EXPECT_EQ(folder.files(), 1);
}

// A journal whose file somebody has moved away, which has noticed it.
struct Moved {
  TemporaryFolder folder;
  const std::filesystem::path place = folder.path() / "journal";
  Volume volume = sampleVolume();
  const std::vector<std::uint32_t> bricks = {0, 3};
  JournalWriter writer;
  explicit Moved(JournalOptions options = {}) : writer(place, header(), std::move(options)) {
    for (int i = 1; i <= 3; ++i) writer.edit({{dab(i)}});
    writer.flush();
    std::filesystem::rename(journalFile(place), place / "moved");
    writer.edit({{dab(4)}});
    writer.flush();
    EXPECT_TRUE(writer.canBeginAnew());
  }
  [[nodiscard]] JournalBeginning beginning() const { return {{7, 11}, &volume, bricks}; }
};

TEST(JournalWriter, BeginsAnewWithWhatEditsHaveMade) {
  std::uint64_t told = 0;
  JournalOptions options;
  options.on_acknowledged = [&](std::uint64_t record) { told = record; };
  Moved s(options);
  EditCommand stamp;
  stamp.kind = EditKind::kStampAdd;
  stamp.stamp = RandomEdits::ball(2e-3);
  s.writer.gatherAnew(4);
  EXPECT_FALSE(s.writer.canBeginAnew());
  EXPECT_EQ(s.writer.edit({{dab(5)}}), 5U);  // meanwhile
  s.writer.beginAnew(s.beginning());
  EXPECT_FALSE(s.writer.failed());
  EXPECT_EQ(s.writer.failure(), "");
  EXPECT_GE(told, 4U);
  EXPECT_EQ(s.writer.edit({{stamp}}, RecordKind::kEditOn), 7U);  // after its stamp's record
  s.writer.close();
  EXPECT_EQ(s.writer.acknowledged(), 7U);
  const Journal journal = readJournal(s.place);
  EXPECT_FALSE(journal.damage);
  ASSERT_TRUE(journal.base);
  EXPECT_EQ(journal.base->mark, (EditMark{7, 11}));
  EXPECT_THAT(journal.base->bricks.bricks, ElementsAre(0, 3));
  ASSERT_EQ(journal.records.size(), 2U);
  EXPECT_EQ(journal.records[0].sequence, 5U);
  EXPECT_EQ(journal.records[0].commands.at(0).from_W.x(), 5);
  EXPECT_NE(journal.records[1].commands.at(0).stamp, nullptr);
  EXPECT_EQ(s.writer.bytes(), bytesOf(s.place).size());
}

// What it began with cannot be undone by a record, so it must begin with something else.
TEST(JournalWriter, MustBeginAnewWhereAnUndoGoesBehindItsBeginning) {
  for (const bool by_redo : {false, true}) {
    Moved s;
    s.writer.gatherAnew(4);
    s.writer.beginAnew(s.beginning());
    s.writer.edit({{dab(5)}});
    s.writer.undo();
    s.writer.redo();
    s.writer.undo();
    EXPECT_FALSE(s.writer.failed());
    if (by_redo) s.writer.redo();
    EXPECT_EQ(by_redo ? s.writer.redo() : s.writer.undo(), by_redo ? 10U : 9U);
    EXPECT_FALSE(s.writer.failed());  // whoever waits for the disk goes on waiting
    EXPECT_FALSE(s.writer.flush());
    s.writer.edit({{dab(7)}});
    EXPECT_EQ(s.writer.acknowledged(), by_redo ? 9U : 8U);
    ASSERT_TRUE(s.writer.canBeginAnew());
    s.writer.gatherAnew(9);
    s.writer.edit({{dab(6)}});
    s.writer.beginAnew(s.beginning());
    EXPECT_TRUE(s.writer.flush());
    s.writer.close();
    const Journal journal = readJournal(s.place);
    EXPECT_FALSE(journal.damage);
    EXPECT_EQ(journal.records.size(), 1U);
    EXPECT_EQ(journal.last_sequence, by_redo ? 12U : 11U);
  }
}

TEST(JournalWriter, AnUndoBehindItsBeginningOnAFullDiskIsAFailure) {
  Moved s;
  s.writer.gatherAnew(4);
  s.writer.beginAnew(s.beginning());
  s.writer.undo();
  EXPECT_FALSE(s.writer.failed());
  {
    const FileSizeLimit full(100);
    s.writer.gatherAnew(5);
    EXPECT_THROW(s.writer.beginAnew(s.beginning()), Error);
  }
  EXPECT_THAT(s.writer.failure(),
              HasSubstr("and it cannot begin anew; edits after number 4 (record 4 of the journal)"));
  EXPECT_TRUE(s.writer.canBeginAnew());
  s.writer.close();
  EXPECT_EQ(readJournal(s.place).last_sequence, 4U);
}

// In a child process, from which no more threads can be started. It was only behind its beginning before.
TEST(JournalWriter, WithoutAThreadItHasFailedAndMayBeginAnew) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a fork has no thread sanitizer";
#endif
  const pid_t child = fork();
  if (child == 0) {
    Moved s;
    s.writer.gatherAnew(4);
    s.writer.beginAnew(s.beginning());
    s.writer.undo();
    s.writer.gatherAnew(5);
    if (!loseCall(SYS_clone3, EAGAIN) || !loseCall(SYS_clone, EAGAIN)) _exit(2);
    try {
      s.writer.beginAnew(s.beginning());
      _exit(3);
    } catch (const std::system_error&) {
    }
    const bool is_told = s.writer.failure().find("no thread can be started for it") != std::string::npos;
    _exit(is_told && s.writer.failed() && s.writer.canBeginAnew() ? 0 : 4);
  }
  int status = -1;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "this kernel has no seccomp";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(JournalWriter, ReplacesNobodyElsesJournal) {
  Moved s;
  JournalWriter other(s.place, header());
  other.edit({{dab(9)}});
  other.close();
  const std::string before = bytesOf(s.place);
  s.writer.gatherAnew(4);
  EXPECT_THAT(refusalOf([&] { s.writer.beginAnew(s.beginning()); }, Error::Code::kBadInput),
              HasSubstr("holds the journal of another session"));
  EXPECT_TRUE(s.writer.canBeginAnew());
  EXPECT_EQ(s.writer.edit({{dab(5)}}), 5U);
  s.writer.close();
  EXPECT_EQ(s.writer.acknowledged(), 3U);
  EXPECT_EQ(bytesOf(s.place), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(s.place), {}), 2) << "something is left of the attempt";
}

// Nobody takes anything out of the queue before the file is there, and an edit does not wait for that.
TEST(JournalWriter, AFullQueueEndsAJournalThatIsBeingMade) {
  JournalOptions options;
  options.queue_bytes = 1000;
  Moved s(options);
  s.writer.gatherAnew(4);
  for (int i = 0; i < 100; ++i) s.writer.edit({{dab(5)}});
  s.writer.beginAnew(s.beginning());
  EXPECT_TRUE(s.writer.failed());
  EXPECT_EQ(s.writer.acknowledged(), 4U);
  EXPECT_EQ(readJournal(s.place).last_sequence, 4U);
  s.writer.gatherAnew(104);
  s.writer.beginAnew(s.beginning());
  s.writer.undo();  // behind its beginning: it has not failed, until the queue is full
  s.writer.gatherAnew(105);
  for (int i = 0; i < 100; ++i) s.writer.edit({{dab(5)}});
  EXPECT_THAT(s.writer.failure(), HasSubstr("its queue was full"));
  s.writer.beginAnew(s.beginning());
  EXPECT_TRUE(s.writer.failed());
  ASSERT_TRUE(s.writer.canBeginAnew());
  s.writer.gatherAnew(205);
  s.writer.beginAnew(s.beginning());
  EXPECT_FALSE(s.writer.failed());
  EXPECT_EQ(s.writer.acknowledged(), 205U);
}

TEST(JournalWriter, AfterADiskThatStaysFullItHasEndedAsBefore) {
  Moved s;
  for (int i = 0; i < 2; ++i) {
    const FileSizeLimit full(100);
    s.writer.gatherAnew(4);
    s.writer.edit({{dab(5)}});
    EXPECT_THROW(s.writer.beginAnew(s.beginning()), Error);
    EXPECT_TRUE(s.writer.canBeginAnew());
    s.writer.flush();
    EXPECT_EQ(s.writer.acknowledged(), 3U);
  }
  EXPECT_FALSE(std::filesystem::exists(journalFile(s.place)));
}

TEST(JournalWriter, WhatEndedForGoodDoesNotBeginAnew) {
  Moved s;
  s.writer.gatherAnew(4);
  s.writer.beginAnew(s.beginning());
  s.writer.end("nobody knows whether the edit was made", ENOMEM);
  EXPECT_TRUE(s.writer.failed());
  EXPECT_FALSE(s.writer.canBeginAnew());
}

// More bricks than a record takes, and records of the file before: their numbers end where the new edits begin.
TEST(JournalWriter, NumbersAManyBricksBeginningBackwards) {
  const Vec3i size{8, 8, 8 * 16500};
  const Volume volume =
      Volume::fromDense(size, sampleLattice(), std::vector<float>(static_cast<std::size_t>(size.prod()), 1.F), {});
  std::vector<std::uint32_t> bricks(16500);
  std::iota(bricks.begin(), bricks.end(), 0U);
  for (const std::uint64_t before : {1U, 2U, 5U}) {
    const TemporaryFolder folder;
    JournalWriter writer(folder.path(), header());
    for (std::uint64_t i = 1; i < before; ++i) writer.edit({{dab(1)}});
    writer.flush();
    std::filesystem::remove(journalFile(folder.path()));
    writer.edit({{dab(2)}});
    writer.flush();
    const std::uint64_t last = writer.appended();
    ASSERT_TRUE(writer.canBeginAnew());
    writer.gatherAnew(before);
    writer.beginAnew({{3, 4}, &volume, bricks});
    EXPECT_EQ(writer.edit({{dab(3)}}), last + 1);
    writer.close();
    const Journal journal = readJournal(folder.path());
    EXPECT_FALSE(journal.damage) << before;
    ASSERT_TRUE(journal.base);
    EXPECT_EQ(journal.base->bricks.bricks, bricks);
    EXPECT_EQ(journal.last_sequence, last + 1);
  }
}

// With the next edit, and without one.
TEST(JournalWriter, AFileThatIsRemovedIsNoticed) {
  for (const bool by_folder : {false, true}) {
    for (const bool has_edit : {false, true}) {
      const TemporaryFolder folder;
      const std::filesystem::path place = folder.path() / "journal";
      JournalWriter writer(place, header());
      writer.edit({{dab(1)}});
      writer.flush();
      ASSERT_EQ(writer.acknowledged(), 1U);
      if (by_folder) {
        std::filesystem::remove_all(place);
      } else {
        std::filesystem::rename(journalFile(place), place / "moved");
      }
      if (has_edit) {
        writer.edit({{dab(2)}});
        writer.flush();
      }
      for (int look = 0; look < 600 && !writer.failed(); ++look)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      EXPECT_THAT(writer.failure(), HasSubstr("somebody has removed or moved it"));
      EXPECT_EQ(writer.acknowledged(), 1U);
      writer.edit({{dab(3)}});
      writer.close();
      EXPECT_EQ(writer.acknowledged(), 1U);
    }
  }
}

}  // namespace journal_writer_test
}  // namespace palpate
