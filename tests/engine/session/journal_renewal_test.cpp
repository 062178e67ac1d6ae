// SPDX-License-Identifier: Apache-2.0
// A journal that fails at random moments of a random session, on a full disk or as somebody removes it, and begins
// anew. Whenever the session is killed, what is on the disk gives a state that the session had, and none is older than
// the newest that was acknowledged.
#include <map>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/journal/recovery.hpp"
#include "engine/reference/edit.hpp"
#include "failing_memory.hpp"
#include "sample_session.hpp"
#include "tests/support/long_run.hpp"

namespace palpate {
namespace journal_renewal_test {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// With an engine that may go, and checkpoints, as a service's; or without, as a window's.
class Failing {
 public:
  Failing(unsigned seed, bool is_served)
      : random_(seed), edits_(volume_.size(), volume_.lattice(), kLow, kHigh, seed), is_served_(is_served) {
    session_.keepJournal(place_, header_.volume);
    session_.keepSaved(volume_, {}, 0);
    if (is_served_) {
      session_.keepAbreast();
      session_.keepCheckpoints(
          place_, {}, {}, [](const std::string&) {}, 0);
    }
    contents_.push_back(contentHash(twin_));
    at_record_[0] = contents_[0];
  }
  ~Failing() { full_.reset(); }

  void step() {
    switch (std::uniform_int_distribution(0, 15)(random_)) {
      case 0:
      case 1:
        return undo();
      case 2:
      case 3:
        return redo();
      case 4:
        if (!is_served_ || std::bernoulli_distribution(0.5)(random_)) return;
        session_.leaveEngine();
        engine_.reset();
        engine_ = std::make_unique<Engine>(volume_, makePlan({}), 30, "");
        return session_.goOnWith(*engine_);
      case 5:
        full_.reset();
        if (std::bernoulli_distribution(0.5)(random_)) full_.emplace(std::uniform_int_distribution(1, 3000)(random_));
        return;
      case 6:
        if (std::bernoulli_distribution(0.7)(random_)) return;
        session_.saver()->wait();
        removed_ += fs::remove_all(place_) > 0;
        return;
      case 7:
        return comeBack();
      case 8:
      case 9:
      case 10:
        feed();
        return;
      default:
        edit();
    }
  }

  // Room again: it is kept again, and holds all.
  void end() {
    full_.reset();
    if (std::bernoulli_distribution(0.5)(random_)) {
      while (session_.journal()->failed()) feed();
      comeBack();
      session_.feedSaver(now_ns_ += 10 * kSecond_ns);
    }
    session_.close();  // the last try, if it was not
    ASSERT_FALSE(session_.journal()->failed());
    comeBack();
    EXPECT_EQ(contentHash(volume_), contents_[done_]);
  }

  // Killed at this moment.
  void comeBack() {
    const bool holds_all = session_.flushJournal();
    if (!fs::exists(journalFile(place_))) return;  // removed; it is noticed within a second
    for (const bool has_checkpoints : {false, true}) {
      Volume back = sampleVolume();
      const Journal journal = readJournal(place_);
      ASSERT_FALSE(journal.damage);
      const Recovered found = recoverSession(journal, has_checkpoints ? place_ : fs::path(), back);
      makeEdits(found.edits, header_.profile, back);
      ASSERT_EQ(contentHash(back), at_record_.at(found.sequence)) << found.sequence;
      ASSERT_GE(found.sequence, session_.journal()->acknowledged());
      if (holds_all) {
        ASSERT_EQ(contentHash(back), contents_[done_]);
      }
      begun_with_bricks += found.begins_with_bricks;
    }
  }

  int renewed = 0, begun_with_bricks = 0, behind = 0;
  [[nodiscard]] int removed() const { return removed_; }

 private:
  void feed() {
    now_ns_ += std::uniform_int_distribution(0, 3000)(random_) * (kSecond_ns / 1000);
    const bool failed = session_.journal()->failed();
    session_.feedSaver(now_ns_);
    if (std::bernoulli_distribution(0.7)(random_)) session_.saver()->wait();
    renewed += failed && !session_.journal()->failed();
  }
  // `content(i)`: of the volume after the i-th of the records that the change made.
  template <typename Change, typename Content>
  void noteRecords(const Change& change, const Content& content) {
    const std::uint64_t before = session_.journal()->appended();
    change();
    const std::uint64_t after = session_.journal()->appended();
    for (std::uint64_t i = 1; i <= after - before; ++i) at_record_[before + i] = content(i, after - before);
    if (session_.journal()->canBeginAnew() && !session_.journal()->failed()) ++behind;
  }
  void edit() {
    const std::vector<EditCommand> commands = {edits_.next()};
    const UndoStep step = std::bernoulli_distribution(0.3)(random_) ? UndoStep::kLast : UndoStep::kNew;
    const std::uint64_t before = contents_[done_];
    bool refused = false;
    std::uint64_t next = 0;
    noteRecords(
        [&] {
          try {
            session_.edit(commands, now_ns_, step);
          } catch (const Error& error) {
            refused = true;
            ASSERT_EQ(error.code(), Error::Code::kBadInput);  // such a brush fits nowhere
            return;
          }
          made_.resize(done_);
          contents_.resize(done_ + 1);
          made_.push_back(commands);
          twin_ = sampleVolume();
          for (const auto& one : made_)
            reference::applyEdits(twin_, lowerEdits(one, twin_.size(), twin_.lattice(), header_.profile));
          contents_.push_back(contentHash(twin_));
          ++done_;
          next = contents_[done_];
        },
        [&](std::uint64_t i, std::uint64_t of) { return i == of ? next : before; });  // a stamp comes first
  }
  void undo() {
    const std::size_t edits = session_.history().editsToUndo(), from = done_;
    if (edits == 0) return;
    noteRecords([&] { session_.undo(now_ns_); }, [&](std::uint64_t i, std::uint64_t) { return contents_[from - i]; });
    done_ -= edits;
  }
  void redo() {
    const std::size_t edits = session_.history().editsToRedo(), from = done_;
    if (edits == 0) return;
    noteRecords([&] { session_.redo(now_ns_); }, [&](std::uint64_t i, std::uint64_t) { return contents_[from + i]; });
    done_ += edits;
  }

  std::mt19937 random_;
  TemporaryFolder folder_;
  const fs::path place_ = folder_.path() / "journal";
  Volume volume_ = sampleVolume(), twin_ = sampleVolume();
  JournalHeader header_ = sampleHeader(volume_);
  RandomEdits edits_;
  const bool is_served_;
  std::int64_t now_ns_ = 0;
  int removed_ = 0;
  std::vector<std::vector<EditCommand>> made_;  // done and undone
  std::size_t done_ = 0;
  std::vector<std::uint64_t> contents_;               // by edits in effect
  std::map<std::uint64_t, std::uint64_t> at_record_;  // by the number of the newest record
  std::optional<FileSizeLimit> full_;
  std::unique_ptr<Engine> engine_ = std::make_unique<Engine>(volume_, makePlan({}), 30, "");
  EditSession session_{*engine_, header_.profile, {}, kMuch};
};

TEST(JournalRenewal, NothingAcknowledgedIsLost) {
  int renewed = 0, begun = 0, removed = 0, behind = 0;
  const unsigned seeds = isLongRun() ? 200 : 8;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    Failing session(seed, seed % 2 == 0);
    for (int i = 0; i < 200; ++i) ASSERT_NO_FATAL_FAILURE(session.step()) << seed << ", " << i;
    ASSERT_NO_FATAL_FAILURE(session.end()) << seed;
    renewed += session.renewed;
    begun += session.begun_with_bricks;
    removed += session.removed();
    behind += session.behind;
  }
  EXPECT_GE(renewed, 16);
  EXPECT_GE(begun, 16);
  EXPECT_GE(removed, 8);
  EXPECT_GE(behind, 4);
}

// What a journal begins with is in one place. A checkpoint follows at once, or at the session's end, and nothing
// depends on a single bit. On a full disk it fails, and the end does not wait for it.
TEST(JournalRenewal, WhatItBeginsWithIsCopied) {
  for (const bool is_at_end : {false, true}) {
    for (const bool is_full : {false, true}) {
      SCOPED_TRACE(fmt::format("at the end {}, full {}", is_at_end, is_full));
      const TemporaryFolder folder;
      const fs::path place = folder.path() / "journal";
      Session s;
      s.session.keepJournal(place, s.header.volume);
      s.session.keepSaved(s.volume, {}, 0);
      s.session.keepAbreast();
      s.session.keepCheckpoints(place, {}, {}, [](const std::string&) {});
      auto feed = [&, now_ns = std::int64_t{0}]() mutable {
        s.session.feedSaver(now_ns += 10 * kSecond_ns);
        s.session.saver()->wait();
      };
      EditCommand command = dab(0);
      command.from_W = command.to_W = s.volume.lattice().toWorld({13, 10, 9});
      s.session.edit({{command}}, 0);
      EXPECT_TRUE(s.session.flushJournal());
      fs::remove_all(place);
      EXPECT_FALSE(s.session.flushJournal());
      feed();
      ASSERT_TRUE(s.session.flushJournal());
      const std::uint64_t content = s.hash();
      {
        std::optional<FileSizeLimit> full;
        if (is_full) full.emplace(100);
        if (!is_at_end || is_full) feed();
        if (is_at_end) s.session.close();
      }
      std::string bytes = bytesOf(place);
      bytes[bytes.size() - 40] ^= 1;
      setBytes(place, bytes);
      Volume back = sampleVolume();
      const Recovered found = recoverSession(readJournal(place), place, back);
      EXPECT_EQ(found.lost_records, is_full ? 1U : 0U);  // that made the bricks
      EXPECT_EQ(contentHash(back), is_full ? contentHash(sampleVolume()) : content);
    }
  }
}

// A copy of the volume that is incomplete is no beginning: nobody waits for one then.
TEST(JournalRenewal, WithoutAWholeCopyAnUndoBehindTheBeginningIsAFailure) {
  for (const bool is_closed : {false, true}) {
    const TemporaryFolder folder;
    Session s;
    s.session.keepJournal(folder.path() / "journal", s.header.volume);
    s.session.keepSaved(s.volume, {}, 0);
    s.session.edit({{dab(0)}}, 0);
    EXPECT_TRUE(s.session.flushJournal());
    fs::remove_all(folder.path() / "journal");
    EXPECT_FALSE(s.session.flushJournal());
    s.session.feedSaver(0);
    s.session.saver()->wait();
    ASSERT_TRUE(s.session.flushJournal());
    EXPECT_EQ(s.session.journal()->timesMended(), 1U);
    s.session.saver()->abandon("no memory");
    s.session.undo(0);
    EXPECT_FALSE(s.session.flushJournal());
    EXPECT_FALSE(s.session.journal()->failed());
    if (is_closed) {
      s.session.close();
    } else {
      s.session.feedSaver(10 * kSecond_ns);
      s.session.saver()->wait();
    }
    EXPECT_THAT(s.session.journal()->failure(), HasSubstr("it cannot begin anew; edits after number 1")) << is_closed;
  }
}

}  // namespace journal_renewal_test
}  // namespace palpate
