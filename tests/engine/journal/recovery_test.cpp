// SPDX-License-Identifier: Apache-2.0
// A journal damaged anywhere, with checkpoints of every kind beside it: what comes back is a state that the session
// had, the newest that anything on the disk leads to, and what is missing is told.
#include "engine/journal/recovery.hpp"

#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/bricks/brick_grid.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"
#include "journal_samples.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace recovery_test {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr std::size_t kEdits = 24;

// A session of random edits without undo, so that record n makes state n, and what the volume was after each.
class Recovery : public testing::Test {
 protected:
  Recovery() {
    header_.id = 77;
    RandomEdits random(start_.size(), start_.lattice(), kLow, kHigh, 23);
    Volume volume = sampleVolume();
    EditTrail trail(header_);
    JournalWriter writer(folder_.path(), header_);
    states_.push_back(contentHash(volume));
    marks_.push_back(*trail.mark());
    begins_.push_back(headerBytes(header_).size());
    for (std::size_t n = 1; n <= kEdits; ++n) {
      EditCommand command;
      while (contentHash(volume) == states_.back()) {  // one that changes something
        command = random.next();
        if (isStamp(command.kind)) continue;
        reference::applyEdits(volume, lowerEdits({{command}}, volume.size(), volume.lattice(), header_.profile));
      }
      trail.edit({{command}}, false);
      writer.edit({{command}});
      commands_.push_back(command);
      writer.flush();
      begins_.push_back(writer.bytes());
      states_.push_back(contentHash(volume));
      marks_.push_back(*trail.mark());
      volumes_.push_back(Volume::fromDense(volume.size(), volume.lattice(), volume.toDense(), {}));
    }
    writer.close();
    bytes_ = bytesOf(folder_.path());
    const auto count = static_cast<std::uint32_t>(BrickGrid{start_.size(), start_.lattice().spacing_m}.brickCount());
    for (std::uint32_t brick = 0; brick < count; ++brick) bricks_.push_back(brick);
  }
  // After record n; `journal`: of which it says that it is.
  void checkpoint(std::size_t number, std::size_t n, std::uint64_t journal = 77) const {
    writeCheckpoint(checkpointFile(folder_.path(), number), {marks_[n], journal, n}, volumes_[n - 1], bricks_);
  }
  // One bit within record n, behind its length.
  void damage(std::size_t n, std::size_t byte = 5) const {
    std::string bytes = bytes_;
    const std::size_t at = begins_[n - 1] + byte;
    bytes[at] = static_cast<char>(bytes[at] ^ 8);
    setBytes(folder_.path(), bytes);
  }
  // Brings the session back, makes the edits, and returns which state that is; -1: none that it had.
  int recover() {
    Volume volume = sampleVolume();
    const Journal journal = readJournal(folder_.path());
    found_ = recoverSession(journal, folder_.path(), volume);
    makeEdits(found_.edits, header_.profile, volume);
    const auto state = std::find(states_.begin(), states_.end(), contentHash(volume));
    if (state == states_.end()) return -1;
    EXPECT_EQ(static_cast<std::ptrdiff_t>(found_.held.edits + found_.edits.size()), state - states_.begin());
    return static_cast<int>(state - states_.begin());
  }

  TemporaryFolder folder_;
  const Volume start_ = sampleVolume();
  JournalHeader header_ = sampleHeader(start_);
  std::string bytes_;
  std::vector<std::size_t> begins_;  // of record n + 1
  std::vector<EditCommand> commands_;
  std::vector<std::uint64_t> states_;
  std::vector<EditMark> marks_;
  std::vector<Volume> volumes_;
  std::vector<std::uint32_t> bricks_;
  Recovered found_;
};

TEST_F(Recovery, OfAWholeJournalHasEveryEdit) {
  EXPECT_EQ(recover(), 24);
  EXPECT_EQ(found_.loss, "");
  checkpoint(0, 10);
  checkpoint(1, 20);
  EXPECT_EQ(recover(), 24);
  EXPECT_EQ(found_.held.edits, 10U);  // the earlier: what comes after it can be undone
  EXPECT_EQ(found_.before.size(), 10U);
  EXPECT_EQ(found_.mark, marks_[10]);
  EXPECT_FALSE(found_.begins_with_bricks);
}

// At each record, with no checkpoint, and with one before, at or beyond it: by its number, its length (which hides how
// long it is, or leads beyond the end) or its content.
TEST_F(Recovery, GoesOnFromACheckpointBeyondTheDamage) {
  for (std::size_t hit = 1; hit <= kEdits; ++hit) {
    for (const std::size_t byte : {0U, 2U, 5U, 25U}) {
      for (const std::size_t at : {std::size_t{0}, hit / 2, hit - 1, hit, std::min(hit + 3, kEdits), kEdits}) {
        fs::remove(checkpointFile(folder_.path(), 1));
        damage(hit, byte);
        if (at > 0) checkpoint(1, at);
        const bool is_beyond = at >= hit;
        EXPECT_EQ(recover(), static_cast<int>(is_beyond ? kEdits : hit - 1)) << hit << " byte " << byte << " at " << at;
        EXPECT_EQ(found_.begins_with_bricks, is_beyond);
        EXPECT_EQ(found_.sequence, is_beyond ? kEdits : hit - 1);
        EXPECT_EQ(found_.lost_records, is_beyond ? 0 : kEdits - hit + 1) << hit << ' ' << byte;
        EXPECT_THAT(found_.loss, HasSubstr(fmt::format("as record {} ", hit)));
      }
    }
  }
}

// One bit anywhere behind the header: what is missing is told, at least; and a checkpoint from beyond it has all.
TEST_F(Recovery, NoBitCostsMoreThanIsTold) {
  for (std::size_t at = begins_[0]; at < bytes_.size(); at += isLongRun() ? 1 : 17) {
    for (std::size_t bit = at % (isLongRun() ? 3 : 8); bit < 8; bit += isLongRun() ? 3 : 8) {
      std::string bytes = bytes_;
      bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ 1U << bit);
      setBytes(folder_.path(), bytes);
      fs::remove(checkpointFile(folder_.path(), 1));
      const int back = recover();
      ASSERT_GE(back, 0) << at << " bit " << bit;
      EXPECT_EQ(found_.lost_records, kEdits - static_cast<std::size_t>(back)) << at << " bit " << bit;
      checkpoint(1, kEdits - 3);
      EXPECT_GE(recover() + static_cast<int>(found_.lost_records), static_cast<int>(kEdits)) << at << " bit " << bit;
      if (back < static_cast<int>(kEdits) - 3) {
        EXPECT_EQ(found_.lost_records, 0U) << at << " bit " << bit;
      }
    }
  }
}

TEST_F(Recovery, TakesTheNewestThatIsWholeAndOfThisJournal) {
  damage(5);
  checkpoint(0, 8);
  checkpoint(1, 12);
  EXPECT_EQ(recover(), 24);
  EXPECT_EQ(found_.held.edits, 12U);
  EXPECT_EQ(found_.mark, marks_[12]);
  std::string broken = contentsOf(checkpointFile(folder_.path(), 1));
  broken[100] = static_cast<char>(broken[100] ^ 1);
  std::ofstream(checkpointFile(folder_.path(), 1), std::ios::binary) << broken;
  EXPECT_EQ(recover(), 24);
  EXPECT_EQ(found_.held.edits, 8U);
  checkpoint(0, 8, 78);
  checkpoint(1, 12, 0);
  EXPECT_EQ(recover(), 4);
  EXPECT_THAT(found_.loss, HasSubstr("is damaged: 20 records in"));
}

// Two places: the checkpoint leads over the first, and the second ends it.
TEST_F(Recovery, EndsAtTheNextDamage) {
  std::string bytes = bytes_;
  for (const std::size_t n : {std::size_t{5}, std::size_t{15}}) bytes[begins_[n - 1] + 6] ^= 1;
  setBytes(folder_.path(), bytes);
  checkpoint(0, 10);
  EXPECT_EQ(recover(), 14);
  EXPECT_EQ(found_.lost_records, 10U);
  EXPECT_THAT(found_.loss, HasSubstr("A checkpoint has the edits up to record 14; 10 records are lost"));
}

// Killed while it wrote the last record: nobody was told that it is saved.
TEST_F(Recovery, ATornEndIsNoLoss) {
  setBytes(folder_.path(), bytes_.substr(0, bytes_.size() - 3));
  EXPECT_EQ(recover(), 23);
  EXPECT_EQ(found_.lost_records, 0U);
  EXPECT_THAT(found_.loss, HasSubstr("was being written when its session ended"));
  checkpoint(0, kEdits);  // but it was written once
  EXPECT_EQ(recover(), 24);
  EXPECT_THAT(found_.loss, HasSubstr("nothing is lost"));
}

// The next session's journal begins with what came back, and gives the same and its own edits; also the one after it.
TEST_F(Recovery, IsTheBeginningOfTheNextJournal) {
  damage(5);
  checkpoint(0, 10);
  const TemporaryFolder next;
  Volume volume = sampleVolume();
  found_ = recoverSession(readJournal(folder_.path()), folder_.path(), volume);
  {
    JournalHeader header = header_;
    header.id = 79;
    JournalWriter writer(next.path(), header, {}, JournalBeginning{found_.mark, &volume, found_.held.bricks});
    EXPECT_EQ(writer.acknowledged(), 1U);
    for (const LastingEdit& edit : found_.edits) writer.edit(edit.commands);
  }
  const Journal journal = readJournal(next.path());
  ASSERT_TRUE(journal.base);
  EXPECT_EQ(journal.base->mark, marks_[10]);
  EXPECT_FALSE(journal.damage);
  for (const bool with_checkpoint : {false, true}) {
    if (with_checkpoint) writeCheckpoint(checkpointFile(next.path(), 0), {marks_[18], 79, 9}, volumes_[17], bricks_);
    Volume back = sampleVolume();
    const Recovered again = recoverSession(journal, next.path(), back);
    EXPECT_EQ(again.held.edits, with_checkpoint ? 18U : 10U);
    EXPECT_TRUE(again.before.empty());  // they are in the bricks, and are not to be made again
    EXPECT_TRUE(again.begins_with_bricks);
    makeEdits(again.edits, header_.profile, back);
    EXPECT_EQ(contentHash(back), states_[kEdits]);
    EXPECT_EQ(again.mark, marks_[again.held.edits]);
  }
  Volume replayed = sampleVolume();
  replay(journal, replayed);
  EXPECT_EQ(contentHash(replayed), states_[kEdits]);
}

// Damage within the beginning leaves nothing to go on from, but for a checkpoint. That is told as well.
TEST_F(Recovery, OfAJournalWhoseBeginningIsDamaged) {
  const TemporaryFolder next;
  JournalHeader header = header_;
  header.id = 79;
  {
    JournalWriter writer(next.path(), header, {}, JournalBeginning{marks_[10], &volumes_[9], bricks_});
    writer.edit({{dab(0)}});
  }
  std::string bytes = bytesOf(next.path());
  bytes[headerBytes(header).size() + 40] ^= 1;
  setBytes(next.path(), bytes);
  Volume volume = sampleVolume();
  const Journal journal = readJournal(next.path());
  const Recovered nothing = recoverSession(journal, next.path(), volume);
  EXPECT_EQ(contentHash(volume), states_[0]);
  EXPECT_EQ(nothing.lost_records, 11U);  // the edit, and the ten that are in the bricks
  EXPECT_EQ(nothing.held.edits + nothing.edits.size(), 0U);
  EXPECT_THAT(nothing.loss, HasSubstr("is damaged: 2 records in"));
  EXPECT_THAT(nothing.loss, HasSubstr("the volume as 10 earlier edits had made it, which are lost as well"));
  writeCheckpoint(checkpointFile(next.path(), 0), {marks_[12], 79, 2}, volumes_[11], bricks_);
  const Recovered found = recoverSession(journal, next.path(), volume);
  EXPECT_EQ(contentHash(volume), states_[12]);
  EXPECT_EQ(found.lost_records, 0U);
}

// One bit of a journal that has begun anew: its bricks stand for ten edits, and its numbers go on from there. Whatever
// is hit, a checkpoint of the same moment has all, with the sound records behind. Without one all that is lost is told,
// or that nobody knows how much.
TEST_F(Recovery, NoBitOfWhatAJournalBeganAnewWithCostsMoreThanIsTold) {
  const TemporaryFolder place;
  JournalWriter writer(place.path() / "journal", header_);
  for (std::size_t n = 0; n < 10; ++n) writer.edit({{commands_[n]}});
  ASSERT_TRUE(writer.flush());
  fs::remove_all(place.path() / "journal");
  EXPECT_FALSE(writer.flush());
  for (int look = 0; look < 1000 && !writer.failed(); ++look) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  writer.gatherAnew(10);
  writer.beginAnew({marks_[10], &volumes_[9], bricks_});
  for (std::size_t n = 10; n < kEdits; ++n) writer.edit({{commands_[n]}});
  writer.close();
  const std::string whole = bytesOf(place.path() / "journal");
  const std::size_t first = headerBytes(header_).size(), head = first + 48;  // and the mark, and how many bricks
  int told_without_number = 0;
  for (std::size_t at = first; at < whole.size(); at += at < head ? 1 : 397) {
    for (std::size_t bit = at % 8; bit < 8; bit += at < head ? 3 : 8) {
      SCOPED_TRACE(fmt::format("byte {} bit {}", at, bit));
      std::string bytes = whole;
      bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ 1U << bit);
      setBytes(folder_.path(), bytes);
      fs::remove(checkpointFile(folder_.path(), 0));
      const int back = recover();
      ASSERT_GE(back, 0);
      if (found_.loss.find("nobody knows how many") != std::string::npos) {
        ++told_without_number;
        EXPECT_EQ(back, 0);
      } else {
        EXPECT_GE(found_.lost_records + static_cast<std::size_t>(back), kEdits);
      }
      writeCheckpoint(checkpointFile(folder_.path(), 0), {marks_[10], header_.id, 10}, volumes_[9], bricks_);
      const int with_checkpoint = recover();
      EXPECT_GE(found_.lost_records + static_cast<std::size_t>(with_checkpoint), kEdits);
      if (back == 0) {
        EXPECT_EQ(with_checkpoint, static_cast<int>(kEdits));
        EXPECT_EQ(found_.lost_records, 0U);
      }
    }
  }
  EXPECT_LE(told_without_number, 4 * 3);  // of the upper half of that number: three bits of each byte
}

TEST_F(Recovery, WhatWasNotReadIsPutAsideUnderAFreeName) {
  std::ofstream(folder_.path() / "journal-unread-1.palpate") << "mine";
  EXPECT_EQ(putAside(folder_.path(), folder_.path()), folder_.path() / "journal-unread-2.palpate");
  EXPECT_EQ(contentsOf(folder_.path() / "journal-unread-2.palpate"), bytes_);
  EXPECT_EQ(contentsOf(folder_.path() / "journal-unread-1.palpate"), "mine");
  EXPECT_FALSE(fs::exists(journalFile(folder_.path())));
  EXPECT_THAT(refusalOf([&] { putAside(folder_.path(), folder_.path()); }, Error::Code::kIo),
              HasSubstr("it cannot be put aside"));
}

TEST_F(Recovery, TheEarlierJournalCountsUntilTheMark) {
  EXPECT_EQ(countingJournal(folder_.path()), folder_.path());
  fs::create_directory(earlierFolder(folder_.path()));
  EXPECT_EQ(countingJournal(folder_.path()), folder_.path());
  std::ofstream(journalFile(earlierFolder(folder_.path()))) << "x";
  EXPECT_EQ(countingJournal(folder_.path()), earlierFolder(folder_.path()));
  EXPECT_EQ(checkpointFolder(earlierFolder(folder_.path())), folder_.path());
  EXPECT_EQ(checkpointFolder(folder_.path()), folder_.path());
  std::ofstream(holdsAllMark(folder_.path())) << "";
  EXPECT_EQ(countingJournal(folder_.path()), folder_.path());
}

}  // namespace recovery_test
}  // namespace palpate
