// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/replay.hpp"

#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/reference/edit.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace replay_test {

using ::testing::HasSubstr;

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// The brick-wise twin against the slow and obvious one, which visits every voxel: where the domain ends in the middle
// of bricks and where it ends with them.
class EditBricks : public testing::TestWithParam<Vec3i> {};

TEST_P(EditBricks, EqualTheDenseTwinBitForBit) {
  Volume volume = sampleVolume(8, GetParam());
  const JournalHeader header = sampleHeader(volume);
  reference::DenseField field = reference::denseField(volume);
  RandomEdits random(volume.size(), volume.lattice(), kLow, kHigh, 3);
  for (int i = 0; i < 400; ++i) {
    std::vector<EditCommand> commands = {random.next()};
    if (i % 3 == 0) commands.push_back(random.next());
    const LoweredEdits lowered = lowerEdits(commands, volume.size(), volume.lattice(), header.profile);
    reference::applyEdits(field, lowered);
    reference::applyEdits(volume, lowered);
    ASSERT_TRUE(sameBits(volume.toDense(), field.values)) << i << " " << editName(commands[0].kind);
  }
  EXPECT_EQ(contentHash(volume), contentHash(Volume::fromDense(field.size, field.lattice, field.values, {})));
}

INSTANTIATE_TEST_SUITE_P(Sizes, EditBricks, testing::Values(Vec3i(27, 22, 19), Vec3i(24, 16, 32)));

JournalRecord record(RecordKind kind, double x_m = 0) {
  return {kind, 0, kind == RecordKind::kEdit ? std::vector<EditCommand>{dab(x_m)} : std::vector<EditCommand>{}};
}

TEST(Replay, UndoAndRedoDecideWhatLasts) {
  Journal journal;
  using enum RecordKind;
  journal.records = {record(kEdit, 1), record(kEdit, 2), record(kEdit, 3), record(kUndo),
                     record(kUndo),    record(kRedo),    record(kEdit, 4), record(kUndo),
                     record(kRedo),    record(kEdit, 5), record(kUndo)};
  std::vector<double> lasting;
  for (const auto& edit : lastingEdits(journal)) lasting.push_back(edit.commands.at(0).from_W.x());
  EXPECT_EQ(lasting, (std::vector<double>{1, 2, 4}));
}

TEST(Replay, AJournalOfRandomEditsGivesTheVolume) {
  TemporaryFolder folder;
  Volume edited = sampleVolume();
  const JournalHeader header = sampleHeader(edited);
  RandomEdits random(edited.size(), edited.lattice(), kLow, kHigh, 11);
  {
    JournalWriter writer(folder.path(), header);
    for (int i = 0; i < 100; ++i) {
      const std::vector<EditCommand> commands = {random.next(), random.next()};
      reference::applyEdits(edited, lowerEdits(commands, edited.size(), edited.lattice(), header.profile));
      writer.edit(commands);
    }
  }
  Volume replayed = sampleVolume();
  replay(readJournal(folder.path()), replayed);
  EXPECT_EQ(contentHash(replayed), contentHash(edited));
  EXPECT_NE(contentHash(replayed), header.volume.content);
}

TEST(Replay, TellsHowFarItIsBeforeEachEditAndCanBeCancelled) {
  Volume volume = sampleVolume();
  Journal journal;
  journal.header = sampleHeader(volume);
  for (const double i : {5.0, 9.0, 13.0, 17.0}) {
    journal.records.push_back(record(RecordKind::kEdit));
    EditCommand& command = journal.records.back().commands[0];
    command.kind = EditKind::kRemove;
    command.from_W = command.to_W = volume.lattice().toWorld({i, 10, 9});
  }
  struct Stopped {};
  Volume cancelled = sampleVolume();
  EXPECT_THROW(replay(journal, cancelled,
                      [](double done) {
                        if (done == 0.5) throw Stopped();
                      }),
               Stopped);
  std::vector<double> told;
  replay(journal, volume, [&](double done) { told.push_back(done); });
  EXPECT_EQ(told, (std::vector<double>{0, 0.25, 0.5, 0.75}));
  // What was done until then stays: the first two edits, and not all.
  journal.records.resize(2);
  Volume two = sampleVolume();
  replay(journal, two);
  EXPECT_EQ(contentHash(cancelled), contentHash(two));
  EXPECT_NE(contentHash(cancelled), contentHash(volume));
}

TEST(Replay, NamesTheVolumeThatItWants) {
  Journal journal;
  journal.header = sampleHeader(sampleVolume(8));
  journal.header.volume.source = "phantom:ball";
  EXPECT_NO_THROW(checkStart(journal, sampleVolume(8), "other.nrrd"));
  try {
    checkStart(journal, sampleVolume(7), "other.nrrd");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "other.nrrd: it is not the volume that the journal began with: its densities are others; "
                 "give that volume with --volume (the journal names phantom:ball)");
  }
}

TEST(Replay, RefusesAnotherVolume) {
  TemporaryFolder folder;
  { const JournalWriter writer(folder.path(), sampleHeader(sampleVolume(8))); }
  const Journal journal = readJournal(folder.path());
  Volume other = sampleVolume(7);
  try {
    replay(journal, other);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Error::Code::kBadInput);
    EXPECT_THAT(error.what(), HasSubstr("not the volume that the journal began with: its densities are others"));
  }
}

}  // namespace replay_test
}  // namespace palpate
