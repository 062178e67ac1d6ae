// SPDX-License-Identifier: Apache-2.0
// A checkpoint gives the volume that its edits made, or nothing.
#include "engine/journal/checkpoint.hpp"

#include <random>

#include <gtest/gtest.h>

#include "base/crc32c.hpp"
#include "base/error.hpp"
#include "engine/bricks/brick_grid.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace checkpoint_test {

namespace fs = std::filesystem;

std::vector<std::uint32_t> allBricks(const Volume& volume) {
  std::vector<std::uint32_t> bricks(BrickGrid{volume.size(), volume.lattice().spacing_m}.brickCount());
  for (std::size_t i = 0; i < bricks.size(); ++i) bricks[i] = static_cast<std::uint32_t>(i);
  return bricks;
}

// A session of random edits, and what the volume was after each.
class Checkpoints : public testing::Test {
 protected:
  Checkpoints() {
    RandomEdits random(volume_.size(), volume_.lattice(), kLow, kHigh, 17);
    EditTrail trail(header_);
    for (int i = 0; i < 30; ++i) {
      edits_.push_back({{random.next()}, false});
      reference::applyEdits(volume_,
                            lowerEdits(edits_.back().commands, volume_.size(), volume_.lattice(), header_.profile));
      trail.edit(edits_.back().commands, false);
      states_.push_back(Volume::fromDense(volume_.size(), volume_.lattice(), volume_.toDense(), {}));
      marks_.push_back(*trail.mark());
    }
  }
  void write(std::size_t number, std::size_t edits) const {
    writeCheckpoint(checkpointFile(folder_.path(), number), {marks_[edits - 1], 0, 0}, states_[edits - 1],
                    allBricks(volume_));
  }
  // How many edits the volume holds that a start gets, which is checked; `of` the first edits.
  [[nodiscard]] std::size_t heldAtStart(std::size_t of = 30) {
    Volume volume = sampleVolume();
    const Headstart held =
        putCheckpoint(folder_.path(), *EditTrail(header_).mark(), std::span(edits_).first(of), volume);
    EXPECT_EQ(contentHash(volume), held.edits == 0 ? header_.volume.content : contentHash(states_.at(held.edits - 1)));
    good_ = held.good;
    EXPECT_EQ(held.bricks, held.edits == 0 ? std::vector<std::uint32_t>{} : allBricks(volume));
    return held.edits;
  }
  Volume volume_ = sampleVolume();
  JournalHeader header_ = sampleHeader(volume_);
  TemporaryFolder folder_;
  std::vector<LastingEdit> edits_;
  std::vector<Volume> states_;
  std::vector<EditMark> marks_;
  CheckpointMarks good_;  // of the last start
};

TEST_F(Checkpoints, AreUsedTheEarlierOneFirst) {
  EXPECT_EQ(heldAtStart(), 0U);
  write(1, 20);
  EXPECT_EQ(heldAtStart(), 20U);
  write(0, 27);
  EXPECT_EQ(heldAtStart(), 20U);
  write(1, 29);
  EXPECT_EQ(heldAtStart(), 27U);
  EXPECT_EQ(good_, (CheckpointMarks{marks_[26], marks_[28]}));
  EXPECT_EQ(heldAtStart(28), 27U);
  EXPECT_EQ(good_, (CheckpointMarks{marks_[26], std::nullopt}));
  EXPECT_EQ(heldAtStart(27), 27U);
  EXPECT_EQ(heldAtStart(26), 0U);  // some of its edits were undone
  removeCheckpoints(folder_.path());
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

// One of the two that is of no use does not hide the other.
TEST_F(Checkpoints, OfOtherEditsAreNotUsed) {
  write(0, 10);
  write(1, 20);
  std::swap(edits_[4], edits_[5]);
  EXPECT_EQ(heldAtStart(), 0U);
  std::swap(edits_[4], edits_[5]);
  std::swap(edits_[14], edits_[15]);
  EXPECT_EQ(heldAtStart(), 10U);
  EXPECT_EQ(good_, (CheckpointMarks{marks_[9], std::nullopt}));
  fs::remove(checkpointFile(folder_.path(), 0));
  EXPECT_EQ(heldAtStart(), 0U);
}

TEST_F(Checkpoints, ThatAreDamagedAreNotUsed) {
  write(0, 10);
  const fs::path file = checkpointFile(folder_.path(), 0);
  const std::string sound = contentsOf(file);
  const auto isUsed = [&](const std::string& bytes) {
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << bytes;
    return heldAtStart() == 10;
  };
  ASSERT_TRUE(isUsed(sound));
  std::mt19937 random(3);
  for (std::size_t at = 0; at < sound.size(); at += at < 80 ? 1 : 997) {
    std::string changed = sound;
    changed[at] = static_cast<char>(changed[at] ^ (1U << (random() % 8)));
    EXPECT_FALSE(isUsed(changed)) << at;
    EXPECT_FALSE(isUsed(sound.substr(0, at))) << at;
  }
  EXPECT_FALSE(isUsed(sound + "x"));
}

// Whoever writes the checksum too: numbers out of range reach nothing.
TEST_F(Checkpoints, WithImpossibleNumbersAreNotUsed) {
  writeCheckpoint(checkpointFile(folder_.path(), 0), {marks_[9], 0, 0}, states_[9], {{0, 1}});
  const fs::path file = checkpointFile(folder_.path(), 0);
  std::string bytes = contentsOf(file);
  bytes.resize(bytes.size() - 4);
  const auto isUsedWith = [&](std::size_t at, std::uint32_t number) {
    std::string changed = bytes;
    std::memcpy(changed.data() + at, &number, sizeof number);
    const std::uint32_t checksum = crc32c(changed);
    changed.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << changed;
    Volume volume = sampleVolume();
    const std::size_t held = putCheckpoint(folder_.path(), *EditTrail(header_).mark(), edits_, volume).edits;
    EXPECT_EQ(contentHash(volume) == header_.volume.content, held == 0);
    return held == 10;
  };
  constexpr std::size_t kCount = 44, kFirstBrick = 48, kFirstValues = 52;
  ASSERT_TRUE(isUsedWith(kCount, 2));
  for (const std::uint32_t number : {1U, 3U, 0xffffffffU}) EXPECT_FALSE(isUsedWith(kCount, number)) << number;
  for (const std::uint32_t number : {0U, 2U, 511U, 513U, 0x40000001U})
    EXPECT_FALSE(isUsedWith(kFirstValues, number)) << number;
  EXPECT_FALSE(isUsedWith(kFirstBrick, 1));  // twice
  EXPECT_FALSE(isUsedWith(kFirstBrick, 9));  // not ascending
  EXPECT_FALSE(isUsedWith(8, 3));            // a version of which nothing is known
  // The last brick lies outside: nothing is put, not even the first one.
  std::uint32_t first_values = 0;
  std::memcpy(&first_values, bytes.data() + kFirstValues, sizeof first_values);
  const std::size_t second = kFirstValues + 4 + first_values * sizeof(float);
  ASSERT_TRUE(isUsedWith(second, 1));
  const auto count = static_cast<std::uint32_t>(allBricks(volume_).size());
  EXPECT_TRUE(isUsedWith(second, count - 1));
  EXPECT_FALSE(isUsedWith(second, count));
}

TEST_F(Checkpoints, ThatCannotBeWrittenLeaveTheOldOne) {
  write(0, 10);
  EXPECT_THROW(writeCheckpoint(folder_.path() / "none" / "file", {marks_[0], 0, 0}, volume_, {}), Error);
  {
    const FileSizeLimit limit(200);
    EXPECT_THROW(write(0, 20), Error);
  }
  EXPECT_EQ(heldAtStart(), 10U);
}

// Twice its size, and so much that the journal beside it goes on.
TEST(Checkpoint, LeavesRoomForTheJournal) {
  const TemporaryFolder folder;
  EXPECT_EQ(roomFor(0), std::uint64_t{64} << 20U);
  EXPECT_EQ(roomFor(3) - roomFor(1), 4U * 2048);
  checkRoomFor(folder.path(), 1);
  checkRoomFor(folder.path() / "none", std::size_t{1} << 50U);  // nobody knows
  try {
    checkRoomFor(folder.path(), std::size_t{1} << 50U);
    ADD_FAILURE() << "there is no such disk";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kIo);
    EXPECT_NE(std::string(error.what()).find("not to take it from the journal"), std::string::npos);
  }
}

}  // namespace checkpoint_test
}  // namespace palpate
