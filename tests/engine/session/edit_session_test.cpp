// SPDX-License-Identifier: Apache-2.0
// Undo, redo and the journal against the volume that the GPU holds, read back, and the CPU twin's replay.
#include "engine/session/edit_session.hpp"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/journal/replay.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kMuch = std::size_t{1} << 30U;

struct Session {
  Volume volume = sampleVolume();
  JournalHeader header = sampleHeader(volume);
  Engine engine;
  EditSession session;

  explicit Session(std::size_t history_bytes = kMuch)
      : engine(volume, makePlan(Scene{}, false), 30, ""), session(engine, header.profile, {}, history_bytes) {
    engine.publishAround(volume.lattice().toWorld({13, 10, 9}), 0);
  }
  std::uint64_t hash() {
    engine.readBack(volume);
    return contentHash(volume);
  }
};

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
  EXPECT_LT(s.session.history().steps(), 100U);  // of 24 bytes each, at least
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
  {
    const FileSizeLimit limit(3000);
    for (int i = 0; i < 100; ++i) edit();
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

}  // namespace
}  // namespace palpate
