// SPDX-License-Identifier: Apache-2.0
// Undo, redo and the journal against the volume that the GPU holds, read back, and the CPU twin's replay.
#include "engine/session/edit_session.hpp"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/journal/replay.hpp"
#include "sample_session.hpp"

namespace palpate {
namespace edit_session_test {

using ::testing::HasSubstr;

// Every state that was passed through comes back, to the bit, going down and up again.
TEST(EditSession, UndoAndRedoGoThroughEveryStateAgain) {
  Session s;
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 2);
  std::vector<std::uint64_t> hashes = {s.hash()};
  for (int i = 0; i < 40; ++i) {
    const std::vector<EditCommand> commands = {random.next(), random.next()};
    s.session.edit(commands, 0);
    hashes.push_back(s.hash());
  }
  for (int i = 39; i >= 0; --i) {
    s.session.undo(0);
    ASSERT_EQ(s.hash(), hashes[i]) << i;
  }
  EXPECT_FALSE(s.session.history().canUndo());
  for (int i = 1; i <= 40; ++i) {
    s.session.redo(0);
    ASSERT_EQ(s.hash(), hashes[i]) << i;
  }
  EXPECT_THROW(s.session.redo(0), Error);
}

TEST(EditSession, AnEditAfterUndoForgetsWhatWasUndone) {
  Session s;
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 4);
  const auto one = [&] { return std::vector<EditCommand>{random.next()}; };
  s.session.edit(one(), 0);
  s.session.edit(one(), 0);
  s.session.undo(0);
  s.session.edit(one(), 0);
  EXPECT_FALSE(s.session.history().canRedo());
  EXPECT_EQ(s.session.history().steps(), 2U);
}

// The budget alone decides how far back undo goes; what is kept stays exact.
TEST(EditSession, TheMemoryBudgetLimitsUndo) {
  constexpr std::size_t kBudget = 150'000;
  Session s(kBudget);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 6);
  std::vector<std::uint64_t> hashes = {s.hash()};
  for (int i = 0; i < 60; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
    hashes.push_back(s.hash());
    ASSERT_LE(s.session.history().bytes(), kBudget);
  }
  const std::size_t kept = s.session.history().steps();
  EXPECT_GT(kept, 0U);
  EXPECT_EQ(kept + s.session.history().forgotten(), 60U);
  for (std::size_t i = 0; i < kept; ++i) s.session.undo(0);
  EXPECT_EQ(s.hash(), hashes[60 - kept]);
  try {
    s.session.undo(0);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no edit to undo"));
  }
}

// Edits that change nothing take memory as well: a script without end must not fill it.
TEST(EditSession, EditsThatChangeNothingAreForgottenToo) {
  Session s(2000);
  EditCommand away = dab(0);
  away.from_W = away.to_W = s.volume.lattice().toWorld({-15, 10, 9});  // 10 mm from the volume
  for (int i = 0; i < 500; ++i) s.session.edit({&away, 1}, 0);
  EXPECT_EQ(s.engine.editVersion(), 500U);
  EXPECT_LT(s.session.history().steps(), 100U);  // of 32 bytes each, at least
  EXPECT_EQ(s.session.history().steps() + s.session.history().forgotten(), 500U);
  s.session.undo(0);
  s.session.redo(0);
  EXPECT_EQ(s.hash(), s.header.volume.content);
}

// The journal's replay through the CPU twin is what the device holds, undo and redo in between included.
TEST(EditSession, ReplayEqualsTheDeviceBitForBit) {
  TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 8);
  for (int i = 0; i < 200; ++i) {
    const unsigned dice = random.pick(5);
    if (dice == 0 && s.session.history().canUndo()) {
      s.session.undo(0);
    } else if (dice == 1 && s.session.history().canRedo()) {
      s.session.redo(0);
    } else {
      const std::vector<EditCommand> commands = {random.next()};
      s.session.edit(commands, 0);
    }
  }
  s.session.close();
  const EditFigures figures = s.session.figures();
  EXPECT_EQ(figures.edits, 200U);
  EXPECT_GE(figures.journalled, 200U);  // and stamps
  EXPECT_EQ(figures.acknowledged, figures.journalled);
  Volume replayed = sampleVolume();
  replay(readJournal(folder.path()), replayed);
  const std::uint64_t held = s.hash();
  EXPECT_EQ(contentHash(replayed), held);
  EXPECT_NE(held, s.header.volume.content);
}

// Strokes of several edits, undone and redone as one: the states at their ends come back, and the journal leads to the
// same volume by the same steps.
TEST(EditSession, JoinedEditsAreUndoneAsOneAlsoAfterAReplay) {
  const TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 12);
  std::vector<std::uint64_t> hashes = {s.hash()};
  std::vector<std::size_t> edits;
  for (int i = 0; i < 60; ++i) {
    const bool joins = i > 0 && random.pick(3) != 0;
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0, joins ? UndoStep::kLast : UndoStep::kNew);
    if (!joins) {
      hashes.push_back(0);
      edits.push_back(0);
    }
    hashes.back() = s.hash();
    ++edits.back();
  }
  const std::size_t steps = edits.size();
  ASSERT_GT(steps, 5U);
  ASSERT_EQ(s.session.history().steps(), steps);
  for (std::size_t i = steps; i-- > 0;) {
    EXPECT_EQ(s.session.history().editsToUndo(), edits[i]);
    s.session.undo(0);
    ASSERT_EQ(s.hash(), hashes[i]) << i;
  }
  for (std::size_t i = 0; i < steps - 2; ++i) {
    EXPECT_EQ(s.session.history().editsToRedo(), edits[i]);
    s.session.redo(0);
    ASSERT_EQ(s.hash(), hashes[i + 1]) << i;
  }
  s.session.close();
  Volume replayed = sampleVolume();
  replay(readJournal(folder.path()), replayed);
  EXPECT_EQ(contentHash(replayed), hashes[steps - 2]);

  // A session that makes them again has the same steps.
  Session again;
  for (const LastingEdit& edit : lastingEdits(readJournal(folder.path())))
    again.session.edit(edit.commands, 0, edit.goes_on ? UndoStep::kLast : UndoStep::kNew);
  ASSERT_EQ(again.session.history().steps(), steps - 2);
  for (std::size_t i = steps - 2; i-- > 0;) {
    EXPECT_EQ(again.session.history().editsToUndo(), edits[i]);
    again.session.undo(0);
    ASSERT_EQ(again.hash(), hashes[i]) << i;
  }
}

// Timed is the way from the call to the window: all of the edit but what is settled afterwards, and no edit that
// reached no window.
TEST(EditSession, FiguresSayWhatReachedTheWindowAndTheDisk) {
  const TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  EditCommand hole = dab(0), away = dab(0);
  hole.from_W = hole.to_W = s.volume.lattice().toWorld({13, 10, 9});
  away.from_W = away.to_W = s.volume.lattice().toWorld({-15, 10, 9});  // 10 mm from the volume
  const Stopwatch watch;
  const Engine::EditResult result = s.session.edit({&hole, 1}, 0);
  const double seconds = watch.seconds();
  ASSERT_TRUE(result.published);
  EXPECT_FALSE(s.session.edit({&away, 1}, 0).published);
  s.session.close();
  const EditFigures figures = s.session.figures();
  EXPECT_EQ(figures.edits, 2U);
  EXPECT_EQ(s.session.edits(), 2U);
  EXPECT_EQ(figures.windows, 1U);
  ASSERT_EQ(figures.edit_to_window_s.size(), 1U);
  double settling = 0, others = 0;
  for (const StageTime& stage : result.stages) (stage.name == "settle" ? settling : others) += stage.seconds;
  constexpr double kRounding = 1e-9;
  EXPECT_GE(figures.edit_to_window_s[0], others - kRounding);
  EXPECT_LE(figures.edit_to_window_s[0], seconds - settling + kRounding);
  EXPECT_EQ(figures.journalled, 2U);
  EXPECT_EQ(figures.acknowledged, 2U);
  EXPECT_EQ(figures.journal_bytes, bytesOf(folder.path()).size());
  EXPECT_EQ(figures.journal_failure, "");
}

// What the engine refuses is neither in the history nor in the journal.
TEST(EditSession, ARefusedEditLeavesNoTrace) {
  TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  EditCommand bad = dab(0);
  bad.radius_m = -1;
  EXPECT_THROW(s.session.edit({&bad, 1}, 0), Error);
  s.session.close();
  EXPECT_EQ(s.session.history().steps(), 0U);
  EXPECT_EQ(readJournal(folder.path()).last_sequence, 0U);
  EXPECT_EQ(s.hash(), s.header.volume.content);
}

// The disk is full in the middle of the session: edits go on, undo too; what counts as saved is, and no more.
TEST(EditSession, GoesOnWhenTheDiskIsFull) {
  TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 9);
  const auto edit = [&] {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
  };
  edit();  // a journal in which nothing came to the disk goes with its session
  while (s.session.figures().acknowledged < 1) std::this_thread::yield();
  {
    const FileSizeLimit limit(3000);
    for (int i = 1; i < 100; ++i) edit();
    s.session.undo(0);
    s.session.close();
  }
  const EditFigures figures = s.session.figures();
  EXPECT_EQ(figures.edits, 101U);
  EXPECT_EQ(s.engine.editVersion(), 101U);
  EXPECT_THAT(figures.journal_failure, HasSubstr("are not saved: make room"));
  EXPECT_LT(figures.acknowledged, figures.journalled);
  const Journal journal = readJournal(folder.path());
  EXPECT_FALSE(journal.damage);
  EXPECT_EQ(journal.last_sequence, figures.acknowledged);
}

// What flushJournal() says is what is on the disk.
TEST(EditSession, KnowsWhetherTheJournalHoldsAll) {
  TemporaryFolder folder;
  Session without;
  EXPECT_FALSE(without.session.flushJournal());
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 12);
  const auto edit = [&] {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
  };
  for (int i = 0; i < 3; ++i) {
    edit();
    EXPECT_TRUE(s.session.flushJournal());
    EXPECT_EQ(readJournal(folder.path()).last_sequence, i + 1U);
  }
  const FileSizeLimit limit(std::filesystem::file_size(journalFile(folder.path())) + 100);
  for (int i = 0; i < 30; ++i) edit();
  EXPECT_FALSE(s.session.flushJournal());
}

// Before it is applied, so that the journal and the volume stay one.
TEST(EditSession, RefusesMoreCommandsThanAnEditMayHave) {
  TemporaryFolder folder;
  Session s;
  s.session.keepJournal(folder.path(), s.header.volume);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 10);
  const std::vector<EditCommand> commands(kMaxCommands + 1, random.next());
  s.session.edit(std::span(commands).first(1), 0);
  const std::uint64_t hash = s.hash();
  EXPECT_THROW(s.session.edit(commands, 0), Error);
  EXPECT_EQ(s.engine.editVersion(), 1U);
  EXPECT_EQ(s.session.history().steps(), 1U);
  s.session.undo(0);
  s.session.redo(0);
  EXPECT_EQ(s.hash(), hash);
  s.session.close();
  EXPECT_EQ(readJournal(folder.path()).last_sequence, 3U);
}

// 3 MiB hold the volume and the room for 256 bricks that is made beforehand (2.5 MiB), and not much more; 32 balls of
// some 40 bricks each overflow it, a removal of what is there does not. What was refused is in no record, so the replay
// is the volume all the same.
TEST(EditSession, AfterAnEditThatMemoryRefusesOthersGoOn) {
  TemporaryFolder folder;
  const Vec3i size(96, 96, 96);
  Volume volume = sampleVolume(8, size);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "", std::uint64_t{3} << 20U);
  EditSession session(engine, header.profile, {}, 0);
  session.keepJournal(folder.path(), header.volume);
  EditCommand add;
  add.kind = EditKind::kAdd;
  add.radius_m = 6e-3;
  int refused = 0;
  for (int i = 0; i < 32; ++i) {
    add.from_W = add.to_W = volume.lattice().toWorld(Vec3(16 + i % 4 * 20, 16 + i / 4 % 4 * 20, 40 + i / 16 * 20));
    try {
      session.edit({&add, 1}, 0);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
      EXPECT_THAT(error.what(), HasSubstr("--gpu-memory"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 32);
  EditCommand remove = add;
  remove.kind = EditKind::kRemove;
  remove.radius_m = 3e-3;
  remove.from_W = remove.to_W = volume.lattice().toWorld(Vec3(13, 10.5, 9));
  EXPECT_NO_THROW(session.edit({&remove, 1}, 0));
  session.close();
  EXPECT_EQ(session.figures().edits, 33U - static_cast<unsigned>(refused));
  engine.readBack(volume);
  Volume replayed = sampleVolume(8, size);
  replay(readJournal(folder.path()), replayed);
  EXPECT_EQ(contentHash(replayed), contentHash(volume));
}

}  // namespace edit_session_test
}  // namespace palpate
