// SPDX-License-Identifier: Apache-2.0
// A session that goes on with one engine after another, some of which have failed: nothing is lost.
#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/journal/replay.hpp"
#include "engine/reference/edit.hpp"
#include "failing_memory.hpp"
#include "sample_session.hpp"
#include "temporary_folder.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace other_engine_test {

using testing::HasSubstr;

constexpr std::int64_t kMillisecond_ns = 1'000'000;
const Vec3i kSize{96, 96, 96};

// Bricks that are lost on their way to the CPU, as with a device that fails, break an engine.
void breakEngine(Engine& engine) {
  ASSERT_GT(engine.changedBricks(), 2U);
  failing_memory::failAfter(4);
  EXPECT_THROW(static_cast<void>(engine.takeChanged(engine.changedBricks())), std::bad_alloc);
  failing_memory::failNoMore();
  ASSERT_TRUE(engine.broken());
}

// What the engine holds.
std::uint64_t heldBy(const Engine& engine) {
  Volume volume = sampleVolume(8, kSize);
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (std::uint32_t brick = 0; brick < static_cast<std::uint32_t>(grid.counts().prod()); ++brick)
    putBrick(volume, grid.brick(brick), engine.content(brick).values);
  return contentHash(volume);
}

// Random edits, undo, redo, hand-overs and files, between which the engine goes at random moments, whole or broken. The
// twin says what the volume is at every depth of the history.
class Wandering {
 public:
  explicit Wandering(unsigned seed)
      : random_(seed),
        edits_(kSize, volume.lattice(), kLow, kHigh, seed),
        engine(std::make_unique<Engine>(volume, makePlan({}), 30, "")),
        session(*engine, header.profile, {}, kMuch) {
    session.keepJournal(folder.path() / "journal", header.volume);
    session.keepSaved(volume, {}, 0);
    session.keepAbreast();
    // A checkpoint with every copy: more often than one would ever be due.
    session.keepCheckpoints(
        folder.path() / "journal", {}, {}, [](const std::string& why) { ADD_FAILURE() << why; }, 0);
    contents_.push_back(contentHash(twin_));
    note();
  }

  void step() {
    switch (std::uniform_int_distribution(0, 19)(random_)) {
      case 0:
      case 1:
        return goOn();
      case 2:
      case 3:
      case 4:
        if (done_ == 0) return;
        session.undo(now_ns_);
        --done_;
        return note();
      case 5:
      case 6:
        if (done_ == made_.size()) return;
        session.redo(now_ns_);
        ++done_;
        return note();
      case 7:
        session.ask(
            [this](const Volume& at, std::uint64_t version) { written_.emplace_back(version, contentHash(at)); });
        ++asked;
        return;
      case 8:
        return comeBack();
      case 9:
      case 10:
      case 11:
        now_ns_ += std::uniform_int_distribution(0, 200)(random_) * kMillisecond_ns;
        session.feedSaver(now_ns_);
        if (std::bernoulli_distribution(0.5)(random_)) session.saver()->wait();
        return;
      default:
        edit();
    }
  }

  // Killed at this moment: what is on the disk gives the volume, with a checkpoint or without.
  void comeBack() {
    ASSERT_TRUE(session.flushJournal());
    const Journal journal = readJournal(folder.path() / "journal");
    const std::vector<LastingEdit> lasting = lastingEdits(journal);
    ASSERT_EQ(lasting.size(), done_);
    Volume back = sampleVolume(8, kSize);
    const Headstart held = putCheckpoint(folder.path() / "journal", *EditTrail(journal.header).mark(), lasting, back);
    ASSERT_EQ(contentHash(back), contents_[held.edits]);
    for (const LastingEdit& edit : std::span(lasting).subspan(held.edits))
      reference::applyEdits(back, lowerEdits(edit.commands, kSize, back.lattice(), header.profile));
    ASSERT_EQ(contentHash(back), contents_[done_]);
    with_checkpoint += held.edits > 0;
  }

  void goOn() {
    const std::uint64_t version = engine->editVersion();
    if (std::bernoulli_distribution(0.5)(random_) && engine->changedBricks() > 2) {
      breakEngine(*engine);
      ++broken;
    }
    session.leaveEngine();
    ASSERT_EQ(contentHash(volume), contents_[done_]);
    engine.reset();
    engine = std::make_unique<Engine>(volume, makePlan({}), 30, "");
    session.goOnWith(*engine);
    ASSERT_EQ(engine->editVersion(), version);
    ASSERT_EQ(session.history().done(), done_);
    ++engines;
  }

  void expectAll() {
    while (done_ > 0) {
      session.undo(now_ns_);
      ASSERT_EQ(heldBy(*engine), contents_[--done_]) << done_;
      note();
    }
    while (done_ < made_.size()) {
      session.redo(now_ns_);
      ASSERT_EQ(heldBy(*engine), contents_[++done_]) << done_;
      note();
    }
    session.close();
    Volume replayed = sampleVolume(8, kSize);
    replay(readJournal(folder.path() / "journal"), replayed);
    EXPECT_EQ(contentHash(replayed), contents_[done_]);
    EXPECT_EQ(contentHash(volume), contents_[done_]);
    EXPECT_EQ(written_.size(), asked);
    for (const auto& [version, content] : written_) EXPECT_EQ(content, at_version_.at(version)) << version;
  }

 private:
  // One in six changes more bricks than are handed over at once.
  void edit() {
    std::vector<EditCommand> commands = {edits_.next()};
    if (std::bernoulli_distribution(1.0 / 6)(random_)) commands[0].radius_m = 30e-3;
    try {
      session.edit(commands, now_ns_);
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), Error::Code::kBadInput);  // such a brush fits nowhere
      return;
    }
    if (done_ != in_twin_) {
      twin_ = sampleVolume(8, kSize);
      for (std::size_t i = 0; i < done_; ++i) makeInTwin(made_[i]);
    }
    made_.resize(done_);
    contents_.resize(done_ + 1);
    made_.push_back(commands);
    makeInTwin(commands);
    contents_.push_back(contentHash(twin_));
    in_twin_ = ++done_;
    note();
  }
  void makeInTwin(std::span<const EditCommand> commands) {
    reference::applyEdits(twin_, lowerEdits(commands, kSize, twin_.lattice(), header.profile));
  }
  void note() { at_version_[engine->editVersion()] = contents_[done_]; }

 public:
  TemporaryFolder folder;
  Volume volume = sampleVolume(8, kSize);
  JournalHeader header = sampleHeader(volume);
  int engines = 0, broken = 0, with_checkpoint = 0;
  std::size_t asked = 0;

 private:
  std::mt19937 random_;
  RandomEdits edits_;
  std::int64_t now_ns_ = 0;
  std::vector<std::vector<EditCommand>> made_;  // done and undone
  std::size_t done_ = 0, in_twin_ = 0;
  Volume twin_ = sampleVolume(8, kSize);
  std::vector<std::uint64_t> contents_;                           // by depth of the history
  std::map<std::uint64_t, std::uint64_t> at_version_;             // the same, by version
  std::vector<std::pair<std::uint64_t, std::uint64_t>> written_;  // the saver's until close()

 public:
  std::unique_ptr<Engine> engine;
  EditSession session;
};

TEST(OtherEngine, NothingIsLost) {
  int engines = 0, broken = 0, with_checkpoint = 0;
  const unsigned seeds = isLongRun() ? 40 : 2;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    Wandering wandering(seed);
    for (int i = 0; i < 120; ++i) ASSERT_NO_FATAL_FAILURE(wandering.step()) << seed << ", " << i;
    ASSERT_NO_FATAL_FAILURE(wandering.expectAll()) << seed;
    engines += wandering.engines;
    broken += wandering.broken;
    with_checkpoint += wandering.with_checkpoint;
  }
  EXPECT_GE(engines, 12);
  EXPECT_GE(broken, 3);
  EXPECT_GE(with_checkpoint, 3);
}

// It is whole, and gone: whatever the saver has not taken in.
struct Left {
  Session s;
  Left() {
    s.session.keepSaved(s.volume, {}, 0);
    s.session.keepAbreast();
    RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 3);
    for (int i = 0; i < 5; ++i) s.session.edit({{random.next()}}, 0);
  }
};

// The copy that memory ran out for is no volume: no engine goes on with it, and the session can be closed.
TEST(OtherEngine, NoneGoesOnWithACopyThatLacksEdits) {
  Left left;
  left.s.session.saver()->abandon("no memory");
  EXPECT_THAT(refusalOf([&] { left.s.session.leaveEngine(); }, Error::Code::kOutOfMemory), HasSubstr("lacks edits"));
  Engine next(left.s.volume, makePlan({}), 30, "");
  EXPECT_THAT(refusalOf([&] { left.s.session.goOnWith(next); }, Error::Code::kOutOfMemory), HasSubstr("lacks edits"));
  EXPECT_NO_THROW(left.s.session.close());
}

// Between two engines a session can end, and so can one whose engine has failed: the volume that it gives back has
// every edit, and what was asked for is done with it.
TEST(OtherEngine, ASessionMayEndWithoutOne) {
  for (const bool is_left : {true, false}) {
    Left left, same;
    const std::uint64_t version = left.s.engine.editVersion();
    breakEngine(left.s.engine);
    if (is_left) left.s.session.leaveEngine();
    std::vector<std::pair<std::uint64_t, std::uint64_t>> written;
    left.s.session.ask([&](const Volume& volume, std::uint64_t at) { written.emplace_back(at, contentHash(volume)); });
    left.s.session.close();
    const std::uint64_t content = same.s.hash();
    EXPECT_EQ(contentHash(left.s.volume), content) << is_left;
    EXPECT_THAT(written, testing::ElementsAre(std::pair(version, content))) << is_left;
  }
}

// Memory that runs out while the session ends, in whichever place: it ends, and whoever is told of a file is told of
// one with every edit.
TEST(OtherEngine, ItEndsAlthoughMemoryRunsOut) {
  Left same;
  const std::uint64_t content = same.s.hash();
  int written = 0;
  for (std::size_t fails = 1; fails <= 24; ++fails) {
    Left left;
    if (fails % 2 == 0) breakEngine(left.s.engine);
    left.s.session.ask([&](const Volume& volume, std::uint64_t) {
      EXPECT_EQ(contentHash(volume), content) << fails;
      ++written;
    });
    failing_memory::failAfter(fails);
    left.s.session.close();
    failing_memory::failNoMore();
  }
  EXPECT_GT(written, 0);
}

// The same between two engines: all edits, or none goes on.
TEST(OtherEngine, NoneGoesOnWithHalfAnEdit) {
  Left same;
  const std::uint64_t content = same.s.hash();
  int whole = 0, lacking = 0;
  for (std::size_t fails = 1; fails <= 40; ++fails) {
    Left left;
    breakEngine(left.s.engine);
    failing_memory::failAfter(fails);
    try {
      left.s.session.leaveEngine();
      failing_memory::failNoMore();
      EXPECT_EQ(contentHash(left.s.volume), content) << fails;
      ++whole;
    } catch (const Error& error) {
      failing_memory::failNoMore();
      EXPECT_EQ(error.code(), Error::Code::kOutOfMemory);
      EXPECT_THROW(left.s.session.goOnWith(same.s.engine), Error);
      ++lacking;
    }
  }
  EXPECT_GT(lacking, 0);
  EXPECT_GE(whole + lacking, 40);
}

// A large edit, and the engine's thread copies no more than some hundred bricks at a look.
TEST(OtherEngine, ALargeChangeIsHandedOverInParts) {
  Volume volume = sampleVolume(8, kSize);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, kMuch);
  session.keepSaved(volume, {}, 0);
  session.keepAbreast();
  EditCommand command;
  command.kind = EditKind::kAdd;
  command.from_W = command.to_W = volume.lattice().toWorld(Vec3(48, 48, 48));
  command.radius_m = 30e-3;
  session.edit({&command, 1}, 0);
  std::size_t left = engine.changedBricks();
  ASSERT_GT(left, 512U);
  std::int64_t now_ns = 1'000'000'000;
  while (left > 0) {
    session.feedSaver(now_ns += kMillisecond_ns);
    session.saver()->wait();
    ASSERT_LE(left - engine.changedBricks(), 256U);
    ASSERT_LT(engine.changedBricks(), left);
    left = engine.changedBricks();
  }
}

// A file takes long to write, and large steps go to and fro meanwhile: what is missing is taken from the engine beside
// it, again and again. Then the engine fails.
TEST(OtherEngine, MuchMayChangeWhileAFileIsWritten) {
  Volume volume = sampleVolume(8, kSize), twin = sampleVolume(8, kSize);
  const JournalHeader header = sampleHeader(volume);
  Engine engine(volume, makePlan({}), 30, "");
  EditSession session(engine, header.profile, {}, kMuch);
  session.keepSaved(volume, {}, 0);
  session.keepAbreast();
  std::atomic<bool> is_slow{true};
  session.ask([&](const Volume&, std::uint64_t) {
    while (is_slow) std::this_thread::yield();
  });
  session.feedSaver(0);
  ASSERT_FALSE(session.saver()->ready());
  EditCommand command;
  command.kind = EditKind::kAdd;
  command.from_W = command.to_W = volume.lattice().toWorld(Vec3(48, 48, 48));
  command.radius_m = 30e-3;
  session.edit({&command, 1}, 0);
  int taken = 0;
  for (int i = 0; i < 250; ++i) {
    i % 2 == 0 ? session.undo(0) : session.redo(0);
    session.feedSaver(i);
    taken += engine.changedBricks() == 0 ? 1 : 0;
  }
  EXPECT_GE(taken, 1);
  EXPECT_LE(taken, 4);
  // What was taken is in the copy, although the next large step is handed over in part only when the engine fails.
  EditCommand second = command;
  second.kind = EditKind::kRemove;
  second.radius_m = 28e-3;
  session.edit({&second, 1}, 0);
  is_slow = false;
  for (int i = 0; i < 2; ++i) {
    session.saver()->wait();
    session.feedSaver(1'000'000'000 + i);
  }
  session.saver()->wait();
  ASSERT_GT(engine.changedBricks(), 100U);
  breakEngine(engine);
  session.leaveEngine();
  for (const EditCommand& each : {command, second})
    reference::applyEdits(twin, lowerEdits({&each, 1}, kSize, twin.lattice(), header.profile));
  EXPECT_EQ(contentHash(volume), contentHash(twin));
}

// The copy is completed now and then, so that little is missing: not at every look, and soon when much is.
TEST(OtherEngine, TheCopyIsCompletedNowAndThen) {
  Session s;
  s.session.keepSaved(s.volume, {}, 0);
  s.session.keepAbreast();
  RandomEdits random(s.volume.size(), s.volume.lattice(), kLow, kHigh, 3);
  const auto edit = [&](std::int64_t now_ms) {
    s.session.edit({{random.next()}}, now_ms * kMillisecond_ns);
    const bool is_left = s.engine.changedBricks() > 0;
    s.session.feedSaver(now_ms * kMillisecond_ns);
    s.session.saver()->wait();
    return is_left && s.engine.changedBricks() == 0;
  };
  EXPECT_TRUE(edit(1000));
  for (int now_ms = 1001; now_ms < 1050; ++now_ms) EXPECT_FALSE(edit(now_ms)) << now_ms;
  EXPECT_TRUE(edit(1100));
  int completed = 0;
  for (int i = 0; i < 200; ++i) completed += edit(1101) ? 1 : 0;
  EXPECT_EQ(completed, 3);  // 64 at a time
}

}  // namespace other_engine_test
}  // namespace palpate
