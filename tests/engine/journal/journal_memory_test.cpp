// SPDX-License-Identifier: Apache-2.0
// Memory that fails at every allocation of an append in turn. The edit has been applied by then, so it is in the
// journal or the journal has ended: what is acknowledged can be read, and nothing behind it is.
#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/journal/journal_reader.hpp"
#include "failing_memory.hpp"
#include "journal_samples.hpp"

namespace palpate {
namespace journal_memory_test {

using ::testing::HasSubstr;

TEST(JournalMemory, AnAppendThatFailsEndsTheJournalAtAnEdit) {
  const JournalHeader header = sampleHeader(sampleVolume());
  std::vector<EditCommand> commands(2, dab(0));
  commands[1].kind = EditKind::kStampAdd;
  commands[1].stamp = RandomEdits::ball(2e-3);
  failing_memory::also_in_libraries = true;
  int failures = 0;
  for (std::size_t n = 1;; ++n) {
    const TemporaryFolder folder;
    JournalWriter writer(folder.path(), header);
    for (int i = 0; i < 3; ++i) writer.edit(std::span(commands).first(1));
    writer.undo();
    failing_memory::failAfter(n);
    const std::uint64_t number = writer.edit(commands);
    failing_memory::failNoMore();
    const bool failed = writer.failed();
    if (failed) {
      ++failures;
      EXPECT_THAT(writer.failure(), HasSubstr("no memory for a record")) << n;
      EXPECT_THAT(writer.failure(), HasSubstr("edits after number 4 (record ")) << n;
      EXPECT_THAT(writer.failure(), HasSubstr("are not saved: save the volume itself")) << n;
      EXPECT_GT(number, writer.acknowledged()) << n;
    }
    writer.undo();
    writer.edit(std::span(commands).first(1));
    writer.close();
    const Journal journal = readJournal(folder.path());
    EXPECT_FALSE(journal.damage) << n;
    EXPECT_EQ(journal.last_sequence, writer.acknowledged()) << n;
    // The three and the undo; and, where nothing failed, the edit with its stamp, its undo and one more.
    EXPECT_EQ(journal.records.size(), 4U + (failed ? 0 : 3)) << n;
    if (!failed) break;
  }
  EXPECT_GT(failures, 5);
}

TEST(JournalMemory, UndoAndRedoEndItToo) {
  const JournalHeader header = sampleHeader(sampleVolume());
  for (const auto append : {&JournalWriter::undo, &JournalWriter::redo}) {
    const TemporaryFolder folder;
    JournalWriter writer(folder.path(), header);
    const EditCommand command = dab(0);
    writer.edit({&command, 1});
    const bool is_redo = append == &JournalWriter::redo;
    const std::uint64_t saved = is_redo ? writer.undo() : 1;
    failing_memory::also_in_libraries = true;
    failing_memory::failAfter(1);
    EXPECT_EQ((writer.*append)(), saved + 1);
    failing_memory::failNoMore();
    EXPECT_THAT(writer.failure(),
                HasSubstr(fmt::format("edits after number {0} (record {0} of the journal) are not saved", saved)));
    writer.close();
    EXPECT_EQ(readJournal(folder.path()).last_sequence, saved);
  }
}

}  // namespace journal_memory_test
}  // namespace palpate
