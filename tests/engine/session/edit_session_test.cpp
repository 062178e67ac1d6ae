// SPDX-License-Identifier: Apache-2.0
// Undo, redo and the journal against the volume that the GPU holds, read back, and the CPU twin's replay.
#include "engine/session/edit_session.hpp"

#include <atomic>
#include <mutex>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/journal/replay.hpp"
#include "engine/reference/edit.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace edit_session_test {

using ::testing::HasSubstr;

constexpr std::size_t kMuch = std::size_t{1} << 30U;

struct Session {
  Volume volume = sampleVolume();
  JournalHeader header = sampleHeader(volume);
  Engine engine;
  EditSession session;

  explicit Session(std::size_t history_bytes = kMuch)
      : engine(volume, makePlan({}), 30, ""), session(engine, header.profile, {}, history_bytes) {
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

// Strokes of several edits, undone and redone as one: the states at their ends come back, and the journal, which knows
// single edits, leads to the same volume.
TEST(EditSession, JoinedEditsAreUndoneAsOneAndReplayedOneByOne) {
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

// Two hundred edits with a save due after each of them: every file is the volume at one edit version, the one that it
// names, bit for bit what the twin's replay of so many edits gives.
TEST(EditSession, EverySaveIsTheVolumeAtOneVersion) {
  Session s;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> saved;  // version, content
  const auto write = [&](const Volume& volume, std::uint64_t version) {
    saved.emplace_back(version, contentHash(volume));
    return std::uint64_t{0};
  };
  s.session.keepSaved(s.volume, write, 1);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 10);
  Volume twin = sampleVolume();
  std::vector<std::uint64_t> contents = {contentHash(twin)};
  std::int64_t now_ns = 0;
  for (int i = 0; i < 200; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, now_ns);
    now_ns += 1'500'000'000;
    s.session.feedSaver(now_ns);
    reference::applyEdits(twin, lowerEdits(commands, twin.size(), twin.lattice(), s.header.profile));
    contents.push_back(contentHash(twin));
  }
  s.session.close();
  EXPECT_GE(saved.size(), 2U);
  for (const auto& [version, content] : saved) EXPECT_EQ(content, contents[version]) << "edit " << version;
  EXPECT_EQ(saved.back().first, 200U);
  EXPECT_EQ(s.session.figures().saves.version, 200U);
  EXPECT_EQ(contentHash(s.volume), contents.back());  // given back, with every edit in it
  EXPECT_EQ(s.engine.readBack(s.volume), 0U);
}

// Edits that change more bricks than are handed over at once: the parts are taken while further edits come in between,
// and still no save begins before all of them are there.
TEST(EditSession, ASaveInPartsIsTheVolumeAtOneVersion) {
  const Vec3i size(96, 96, 96);
  Volume volume = sampleVolume(8, size), twin = sampleVolume(8, size);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> saved;
  const auto write = [&](const Volume& now, std::uint64_t version) {
    saved.emplace_back(version, contentHash(now));
    return std::uint64_t{0};
  };
  session.keepSaved(volume, write, 1);
  std::vector<std::uint64_t> contents = {contentHash(twin)};
  std::int64_t now_ns = 0;
  std::size_t most_left = 0;
  for (int i = 0; i < 24; ++i) {
    EditCommand command;
    command.kind = i % 3 == 2 ? EditKind::kRemove : EditKind::kAdd;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(20 + 5 * (i % 12), 48, 70 - 4 * (i % 9)));
    command.radius_m = i % 4 == 0 ? 30e-3 : 3e-3;
    session.edit({&command, 1}, now_ns);
    reference::applyEdits(twin, lowerEdits({&command, 1}, size, twin.lattice(), header.profile));
    contents.push_back(contentHash(twin));
    session.feedSaver(now_ns += 700'000'000);
    most_left = std::max(most_left, engine.changedBricks());
    session.saver()->wait();
  }
  for (int i = 0; i < 20; ++i) {
    session.feedSaver(now_ns += 700'000'000);
    session.saver()->wait();
  }
  const std::size_t beside = saved.size();
  session.close();
  EXPECT_GT(most_left, 0U) << "every edit was handed over whole";
  EXPECT_GE(beside, 2U);
  for (const auto& [version, content] : saved) EXPECT_EQ(content, contents[version]) << "edit " << version;
  EXPECT_EQ(saved.back().first, 24U);
  EXPECT_EQ(contentHash(volume), contents.back());
}

// What is asked for is done with all the edits that were made before, in its order, beside edits that go on; what is
// left is done at the end. A failure is told and stops nothing.
TEST(EditSession, ErrandsHaveEveryEditMadeBefore) {
  Session s;
  s.session.keepSaved(s.volume, {}, 0);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 14);
  std::vector<std::uint64_t> contents = {contentHash(sampleVolume())};
  Volume twin = sampleVolume();
  std::vector<std::pair<int, std::uint64_t>> done;  // number, version
  std::vector<std::uint64_t> seen;
  std::vector<std::uint64_t> asked_at;
  for (int i = 0; i < 60; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
    reference::applyEdits(twin, lowerEdits(commands, twin.size(), twin.lattice(), s.header.profile));
    contents.push_back(contentHash(twin));
    if (i % 7 == 3) {
      asked_at.push_back(s.engine.editVersion());
      s.session.ask([&, n = static_cast<int>(asked_at.size()) - 1](const Volume& volume, std::uint64_t version) {
        done.emplace_back(n, version);
        seen.push_back(contentHash(volume));
        if (n == 2) throw std::runtime_error("a full disk");
      });
    }
    s.session.feedSaver(i);
  }
  s.session.close();
  ASSERT_EQ(done.size(), asked_at.size());
  for (std::size_t i = 0; i < done.size(); ++i) {
    EXPECT_EQ(done[i].first, static_cast<int>(i));
    EXPECT_GE(done[i].second, asked_at[i]);
    EXPECT_EQ(seen[i], contents[done[i].second]) << i;
  }
  EXPECT_EQ(s.session.saver()->takeFailures(), std::vector<std::string>{"a full disk"});
  EXPECT_EQ(s.session.figures().saves.failures, 0U);  // an errand is no save
  EXPECT_FALSE(s.session.figures().saves.version.has_value());
  EXPECT_EQ(contentHash(s.volume), contents.back());
}

// Each edit changes more bricks than a look hands over, and each look comes after an edit: saves are made all the same.
TEST(EditSession, EditsWithoutEndDoNotPutASaveOff) {
  const Vec3i size(96, 96, 96);
  Volume volume = sampleVolume(8, size);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  int saves = 0;
  session.keepSaved(
      volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  for (int i = 0; i < 20; ++i) {
    EditCommand command;
    command.kind = i % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(46 + i % 5, 48, 48));
    command.radius_m = 30e-3;
    EXPECT_GT(session.edit({&command, 1}, now_ns).changed_bricks, 2U * 256);
    session.feedSaver(now_ns += 700'000'000);
    session.saver()->wait();
  }
  EXPECT_GE(saves, 2);
}

// Many bricks wait when a long write is done, and the next save is due: each look takes 256 of them and as many as the
// edit before it changed, no more, and the save is made.
TEST(EditSession, WhatWaitsForADueSaveIsHandedOverInParts) {
  Volume volume = sampleVolume(8, {96, 96, 96});
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, 0);
  std::mutex door;
  std::atomic<int> begun = 0;
  std::unique_lock closed(door);
  const auto write = [&](const Volume&, std::uint64_t) {
    ++begun;
    const std::lock_guard open(door);
    return std::uint64_t{1};
  };
  session.keepSaved(volume, write, 1);
  std::int64_t now_ns = 0;
  const auto changed = [&] { return engine.changedBricks(); };
  const auto edit = [&](double radius_m, int i) {
    EditCommand command;
    command.kind = i % 2 == 0 ? EditKind::kAdd : EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld(Vec3(46 + i % 5, 48, 48));
    command.radius_m = radius_m;
    session.edit({&command, 1}, now_ns);
  };
  for (int i = 0; begun == 0; ++i) {
    edit(3e-3, i);
    session.feedSaver(now_ns += 1'500'000'000);
  }
  edit(60e-3, 0);
  session.feedSaver(now_ns += 1'500'000'000);
  ASSERT_GT(changed(), 1024U);
  closed.unlock();
  session.saver()->wait();
  for (int i = 0; i < 20; ++i) {
    const std::size_t before = changed();
    edit(3e-3, i);
    const std::size_t listed = changed();
    session.feedSaver(now_ns += 1'500'000'000);
    EXPECT_LE(listed - changed(), 256 + (listed - before)) << i;
    session.saver()->wait();
  }
  EXPECT_GE(begun, 2);
}

// An edit beside the volume counts, but the file holds the volume at its version already.
TEST(EditSession, AnEditThatReachesNothingIsNotSaved) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  EditCommand command = dab(0);
  command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
  EditCommand away = dab(0);
  away.from_W = away.to_W = s.volume.lattice().toWorld({-15, 10, 9});  // 10 mm from the volume
  s.session.edit({&command, 1}, 0);
  for (int i = 0; i < 20; ++i) {
    s.session.feedSaver(now_ns += 1'500'000'000);
    s.session.saver()->wait();
    s.session.edit({&away, 1}, now_ns);
  }
  EXPECT_EQ(saves, 1);
  s.session.close();
  EXPECT_EQ(saves, 1);
  EXPECT_EQ(s.session.figures().saves.version, 21U);
}

// A save stands still for as long as the test likes: edits are applied, windows published and looks taken all the
// same, no second save is begun, and what changed meanwhile is in the next one.
TEST(EditSession, EditsGoOnDuringASlowSave) {
  Session s;
  std::mutex door;
  std::atomic<int> begun = 0;
  std::unique_lock closed(door);
  const auto write = [&](const Volume& volume, std::uint64_t) {
    ++begun;
    const std::lock_guard open(door);
    return contentHash(volume);
  };
  s.session.keepSaved(s.volume, write, 1);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 12);
  std::int64_t now_ns = 0;
  const auto edit = [&] {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, now_ns);
    now_ns += 1'500'000'000;
    s.session.feedSaver(now_ns);
  };
  while (begun == 0) edit();
  const std::uint64_t before = s.engine.editVersion();
  for (int i = 0; i < 100; ++i) edit();
  EXPECT_EQ(s.engine.editVersion(), before + 100);  // the save has not ended: it needs the door
  EXPECT_EQ(begun, 1);
  EXPECT_TRUE(s.session.figures().saves.seconds.empty());
  closed.unlock();
  s.session.close();
  EXPECT_EQ(begun, 2);  // the one of the end; nothing was queued
  const SaveFigures saves = s.session.figures().saves;
  EXPECT_EQ(saves.version, s.engine.editVersion());
  EXPECT_EQ(saves.bytes, contentHash(s.volume));
}

TEST(EditSession, WithoutAPeriodItIsSavedOnceAtTheEnd) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 0);
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 14);
  for (int i = 0; i < 20; ++i) {
    const std::vector<EditCommand> commands = {random.next()};
    s.session.edit(commands, 0);
    s.session.feedSaver(i * std::int64_t{1'000'000'000'000});
  }
  s.session.close();
  s.session.close();
  EXPECT_EQ(saves, 1);
}

// The first look begins the first period of 1.5 s, each save another one. A save that was due while nothing had changed
// begins with the first look after a change. A save that failed is tried again a period later, though nothing changed.
TEST(EditSession, SavesAreDueAPeriodApart) {
  std::vector<std::uint64_t> tried;
  bool full = false;
  Session s;
  const auto write = [&](const Volume&, std::uint64_t version) -> std::uint64_t {
    tried.push_back(version);
    if (full) throw Error(Error::Code::kIo, "file", "the disk is full", "make room");
    return 1;
  };
  s.session.keepSaved(s.volume, write, 1.5);
  const auto look = [&](std::int64_t now_ns) {
    s.session.feedSaver(now_ns);
    s.session.saver()->wait();
    return tried.size();
  };
  double radius_m = 1e-3;
  const auto edit = [&] {
    EditCommand command = dab(0);
    command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
    command.radius_m = radius_m += 0.5e-3;
    EXPECT_GT(s.session.edit({&command, 1}, 0).changed_bricks, 0U);
  };
  edit();
  EXPECT_EQ(look(5'000'000'000), 0U);
  EXPECT_EQ(look(6'499'999'999), 0U);
  EXPECT_EQ(look(6'500'000'000), 1U);
  edit();
  EXPECT_EQ(look(7'999'999'999), 1U);
  EXPECT_EQ(look(8'000'000'000), 2U);
  EXPECT_EQ(look(20'000'000'000), 2U);
  edit();
  EXPECT_EQ(look(20'000'000'001), 3U);
  edit();
  full = true;
  EXPECT_EQ(look(30'000'000'000), 4U);
  EXPECT_EQ(s.session.figures().saves.version, 3U);
  full = false;
  EXPECT_EQ(look(31'499'999'999), 4U);
  EXPECT_EQ(look(31'500'000'000), 5U);
  EXPECT_EQ(s.session.figures().saves.version, 4U);
  EXPECT_EQ(s.session.figures().saves.failures, 1U);
  EXPECT_THAT(tried, testing::ElementsAre(1, 2, 3, 4, 4));
}

// There is a file at the end in any case.
TEST(EditSession, WithoutAnEditTheVolumeIsSavedAtTheEnd) {
  std::vector<std::uint64_t> saved;
  Session s;
  const auto write = [&](const Volume& volume, std::uint64_t version) {
    saved.push_back(version);
    return contentHash(volume);
  };
  s.session.keepSaved(s.volume, write, 1);
  s.session.close();
  EXPECT_THAT(saved, testing::ElementsAre(0));
  EXPECT_EQ(s.session.figures().saves.version, 0U);
  EXPECT_EQ(s.session.figures().saves.bytes, s.header.volume.content);
}

TEST(EditSession, WhatDidNotChangeIsNotSavedAgain) {
  Session s;
  int saves = 0;
  s.session.keepSaved(
      s.volume, [&](const Volume&, std::uint64_t) { return static_cast<std::uint64_t>(++saves); }, 1);
  std::int64_t now_ns = 0;
  const auto look = [&] {
    for (int i = 0; i < 20; ++i) {
      s.session.feedSaver(now_ns += 1'500'000'000);
      s.session.saver()->wait();
    }
  };
  look();
  EXPECT_EQ(saves, 0);
  EditCommand command = dab(0);
  command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
  s.session.edit({&command, 1}, 0);
  look();
  EXPECT_EQ(saves, 1);
  s.session.close();
  EXPECT_EQ(saves, 1);
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
