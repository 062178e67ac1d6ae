// SPDX-License-Identifier: Apache-2.0
// What the journal calls saved is on the disk, not only in the system's memory: seen by watching what it asks of the
// disk, since a killed program does not lose what the system has.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "disk_watch.hpp"
#include "engine/journal/journal_reader.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace journal_disk_test {

using ::testing::HasSubstr;

const JournalHeader& header() {
  static const JournalHeader kHeader = sampleHeader(sampleVolume());
  return kHeader;
}

TEST(JournalDisk, AcknowledgesOnlyWhatWasFlushed) {
  const TemporaryFolder folder;
  const std::string file = journalFile(folder.path());
  const std::size_t first = headerBytes(header()).size();
  constexpr std::uint64_t kDabBytes = kRecordFrame + 4 + 2 + std::size_t{9} * 8;  // count; kind, flags; 9 numbers
  std::uint64_t acknowledgements = 0;
  std::uint64_t unsaved = 0;
  JournalOptions options;
  options.gather = std::chrono::microseconds(100);
  options.on_acknowledged = [&](std::uint64_t newest) {
    ++acknowledgements;
    if (static_cast<std::uint64_t>(disk_watch::flushedBytes(file)) < first + newest * kDabBytes) ++unsaved;
  };
  JournalWriter writer(folder.path(), header(), options);
  for (int i = 0; i < 100; ++i) {
    const EditCommand command = dab(i * 1e-3);
    writer.edit({&command, 1});
    if (i % 10 == 0) writer.flush();
  }
  writer.close();
  EXPECT_EQ(writer.acknowledged(), 100U);
  EXPECT_GE(acknowledgements, 10U);
  EXPECT_EQ(unsaved, 0U);
}

TEST(JournalDisk, NamesTheFileWhenItsHeaderIsThere) {
  const TemporaryFolder folder;
  const JournalWriter writer(folder.path(), header());
  const std::string file = journalFile(folder.path());
  ASSERT_TRUE(disk_watch::named.contains(file));
  EXPECT_EQ(disk_watch::named.at(file), 1);
}

// The system says so once only, to the one who asks: then what it had written may be gone.
TEST(JournalDisk, ADiskThatFailsEndsTheJournal) {
  const TemporaryFolder folder;
  JournalWriter writer(folder.path(), header());
  const EditCommand command = dab(0);
  writer.edit({&command, 1});
  writer.flush();
  disk_watch::error_of_next_flush = EIO;
  writer.edit({&command, 1});
  writer.flush();
  EXPECT_TRUE(writer.failed());
  EXPECT_EQ(writer.acknowledged(), 1U);
  EXPECT_THAT(writer.failure(), HasSubstr("(Input/output error); edits after number 1 (record 1 of the journal)"));
  writer.close();
  const Journal journal = readJournal(folder.path());
  EXPECT_EQ(journal.last_sequence, 1U);
  EXPECT_FALSE(journal.damage);
}

}  // namespace journal_disk_test
}  // namespace palpate
