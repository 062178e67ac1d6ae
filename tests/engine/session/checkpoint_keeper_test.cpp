// SPDX-License-Identifier: Apache-2.0
// When a checkpoint is due, into which file it goes, and what becomes of one that cannot be written.
#include "engine/session/checkpoint_keeper.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/edit/lower_edit.hpp"
#include "engine/reference/edit.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace checkpoint_keeper_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

// A session of dabs that never meet, without an engine: the volume is the saver's.
class CheckpointKeepers : public testing::Test {
 protected:
  void edit(double seconds) {
    EditCommand command = dab(0);
    command.from_W = command.to_W = volume_.lattice().toWorld({3. + 2 * static_cast<double>(edits_.size()), 10, 9});
    edits_.push_back({{command}, false});
    const LoweredEdits lowered = lowerEdits(edits_.back().commands, volume_.size(), volume_.lattice(), header_.profile);
    reference::applyEdits(volume_, lowered);
    for (std::uint32_t brick = 0; brick < kBricks; ++brick) state_.note({{brick}});
    state_.edited(edits_.back().commands, false, edits_.size());
    keeper_.edited(seconds);
  }
  bool writeIfDue(std::int64_t now_ns) {
    if (!keeper_.isDue(now_ns)) return false;
    keeper_.writer(now_ns, 0)(volume_);
    return true;
  }
  // How many edits the files hold that a start after a crash could use, in the order of the files.
  [[nodiscard]] std::vector<std::uint64_t> onDisk() const {
    Volume volume = sampleVolume();
    std::vector<std::uint64_t> edits;
    for (const auto& mark : putCheckpoint(folder_.path(), *EditTrail(header_).mark(), edits_, volume).good)
      if (mark) edits.push_back(mark->edits);
    return edits;
  }

  static constexpr std::uint32_t kBricks = 4 * 3 * 3;
  Volume volume_ = sampleVolume();
  JournalHeader header_ = sampleHeader(volume_);
  TemporaryFolder folder_;
  std::vector<std::string> told_;
  std::vector<LastingEdit> edits_;
  EditedState state_{header_};
  CheckpointKeeper keeper_{
      folder_.path(), state_, header_.id, {}, [this](const std::string& why) { told_.push_back(why); }};
};

TEST_F(CheckpointKeepers, WriteOneOnceTheEditsSinceTheLastTookLong) {
  EXPECT_FALSE(writeIfDue(0));
  edit(0.2);
  EXPECT_FALSE(writeIfDue(0));
  edit(0.11);
  EXPECT_TRUE(writeIfDue(0));
  EXPECT_FALSE(writeIfDue(100 * kSecond_ns));
  edit(0.29);
  EXPECT_FALSE(writeIfDue(200 * kSecond_ns));
  edit(0.02);
  EXPECT_TRUE(writeIfDue(300 * kSecond_ns));
  EXPECT_THAT(onDisk(), ElementsAre(2, 4));
  EXPECT_THAT(told_, IsEmpty());
}

TEST_F(CheckpointKeepers, KeepTheTwoNewest) {
  for (std::uint64_t i = 1; i <= 5; ++i) {
    edit(1);
    EXPECT_TRUE(writeIfDue(static_cast<std::int64_t>(i) * 100 * kSecond_ns));
    using Files = std::vector<std::uint64_t>;
    const Files newest = i == 1 ? Files{1} : i % 2 == 0 ? Files{i - 1, i} : Files{i, i - 1};
    EXPECT_EQ(onDisk(), newest) << i;
  }
}

// The one that an undo has made useless goes first, and the other one stays.
TEST_F(CheckpointKeepers, OverwriteTheOneWhoseEditsWereUndone) {
  for (int i = 1; i <= 2; ++i) {
    edit(1);
    ASSERT_TRUE(writeIfDue(i * 100 * kSecond_ns));
  }
  state_.undone();
  keeper_.undone();
  edits_.pop_back();
  EXPECT_THAT(onDisk(), ElementsAre(1));
  edits_.push_back({{dab(7)}, false});
  state_.edited(edits_.back().commands, false, 2);
  keeper_.edited(1);
  ASSERT_TRUE(writeIfDue(300 * kSecond_ns));
  EXPECT_THAT(onDisk(), ElementsAre(1, 2));
}

// Writing may take a twentieth of the time: the next one waits that long.
TEST_F(CheckpointKeepers, DoNotWriteAllTheTime) {
  edit(1);
  ASSERT_TRUE(keeper_.isDue(0));
  const auto write = keeper_.writer(0, 0);
  const auto begin = std::chrono::steady_clock::now();
  write(volume_);
  const std::chrono::nanoseconds at_most_ns = std::chrono::steady_clock::now() - begin;
  edit(1);
  EXPECT_FALSE(keeper_.isDue(1));
  EXPECT_TRUE(keeper_.isDue(20 * at_most_ns.count() + kSecond_ns));
}

// What a journal begins with is nowhere else, so it is copied before the first edit; once.
TEST_F(CheckpointKeepers, WriteOneAtOnceWhereTheJournalBeganAnew) {
  edit(0.1);
  EXPECT_FALSE(writeIfDue(0));
  keeper_.journalBeganAnew();
  EXPECT_TRUE(writeIfDue(0));
  EXPECT_FALSE(writeIfDue(100 * kSecond_ns));
  EXPECT_THAT(onDisk(), ElementsAre(1));
}

// A disk that has no room for it now has some later.
TEST_F(CheckpointKeepers, TryAgainWhereTheJournalBeganAnew) {
  edit(0.1);
  keeper_.journalBeganAnew();
  {
    const FileSizeLimit full(100);
    EXPECT_TRUE(writeIfDue(0));
  }
  EXPECT_THAT(onDisk(), IsEmpty());
  EXPECT_FALSE(writeIfDue(9 * kSecond_ns));
  EXPECT_TRUE(writeIfDue(10 * kSecond_ns));
  EXPECT_THAT(onDisk(), ElementsAre(1));
  EXPECT_FALSE(writeIfDue(100 * kSecond_ns));
}

// A start goes on where the one before it was: what is made again up to the newer file is in that already.
TEST_F(CheckpointKeepers, AreNotWrittenAgainForWhatAFileHolds) {
  for (int i = 1; i <= 3; ++i) {
    edit(1);
    ASSERT_TRUE(writeIfDue(i * 100 * kSecond_ns));
  }
  edit(0.1);
  Volume next = sampleVolume();
  const Headstart held = putCheckpoint(folder_.path(), *EditTrail(header_).mark(), edits_, next);
  ASSERT_EQ(held.edits, 2U);
  EditedState state(header_);
  state.begin(*EditTrail(header_).mark(), std::span(edits_).first(2), held.bricks);
  CheckpointKeeper keeper(folder_.path(), state, header_.id, held, {});
  EXPECT_FALSE(keeper.isDue(0));
  state.edited(edits_[2].commands, false, 1);
  keeper.edited(1);
  EXPECT_FALSE(keeper.isDue(0));
  state.edited(edits_[3].commands, false, 2);
  keeper.edited(0.1);
  EXPECT_FALSE(keeper.isDue(0));
  state.edited({{dab(5)}}, false, 3);
  keeper.edited(0.25);
  EXPECT_TRUE(keeper.isDue(0));
}

// Edits go on, it is told once, and the next attempt goes to the same file.
TEST_F(CheckpointKeepers, TellOnceThatNoneCanBeWritten) {
  for (int i = 1; i <= 2; ++i) {
    edit(1);
    ASSERT_TRUE(writeIfDue(i * 100 * kSecond_ns));
  }
  {
    const FileSizeLimit full(100);
    for (int i = 3; i <= 4; ++i) {
      edit(1);
      EXPECT_TRUE(writeIfDue(i * 100 * kSecond_ns)) << i;
    }
  }
  EXPECT_THAT(told_, ElementsAre(HasSubstr("no checkpoint was written")));
  edit(1);
  EXPECT_TRUE(writeIfDue(500 * kSecond_ns));
  EXPECT_THAT(onDisk(), ElementsAre(5, 2));
  EXPECT_EQ(told_.size(), 1U);
}

}  // namespace checkpoint_keeper_test
}  // namespace palpate
