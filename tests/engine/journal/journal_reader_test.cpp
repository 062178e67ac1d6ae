// SPDX-License-Identifier: Apache-2.0
// Damage at every byte: what lies before it is read, what is lost is named.
#include "engine/journal/journal_reader.hpp"

#include <array>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "engine/journal/replay.hpp"
#include "journal_samples.hpp"
#include "tests/support/few_descriptors.hpp"
#include "tests/support/refusal.hpp"

namespace palpate {
namespace journal_reader_test {

using ::testing::HasSubstr;

constexpr std::uint64_t kRecords = 6;

// A journal of six edits; where its records begin, and its end.
struct Sample {
  TemporaryFolder folder;
  std::string bytes;
  std::vector<std::size_t> begins;

  Sample() {
    const JournalHeader header = sampleHeader(sampleVolume());
    JournalWriter writer(folder.path(), header);
    begins.push_back(headerBytes(header).size());
    for (std::uint64_t i = 0; i < kRecords; ++i) {
      const std::vector<EditCommand> commands(1 + i % 3, dab(static_cast<double>(i)));
      writer.edit(commands);
      writer.flush();
      begins.push_back(writer.bytes());
    }
    writer.close();
    bytes = bytesOf(folder.path());
  }
  [[nodiscard]] std::uint64_t recordAt(std::size_t byte) const {
    return static_cast<std::uint64_t>(std::upper_bound(begins.begin(), begins.end(), byte) - begins.begin() - 1);
  }
};

TEST(JournalReader, ATailThatIsCutAnywhereLosesOnlyTheCutRecord) {
  const Sample sample;
  for (std::size_t size = sample.begins[0]; size < sample.bytes.size(); ++size) {
    setBytes(sample.folder.path(), sample.bytes.substr(0, size));
    const Journal journal = readJournal(sample.folder.path());
    const std::uint64_t whole = sample.recordAt(size);
    ASSERT_EQ(journal.records.size(), whole) << size;
    const bool at_border = size == sample.begins[whole];
    ASSERT_EQ(journal.damage.has_value(), !at_border) << size;
    if (at_border) continue;
    EXPECT_EQ(journal.damage->first_byte, sample.begins[whole]);
    EXPECT_EQ(journal.damage->bytes, size - sample.begins[whole]);
    EXPECT_EQ(journal.damage->records, 1U);
    EXPECT_EQ(journal.damage->reason, fmt::format("record {} is cut short", whole + 1));
  }
}

// A power cut may leave zeros where the file had got its length and not yet its bytes: at the end, that is no damage of
// anything that was saved. In the middle it is.
TEST(JournalReader, ZerosAtTheEndAreARecordThatWasBeingWritten) {
  const Sample sample;
  const std::size_t last = sample.begins[kRecords - 1];
  for (std::size_t size = last; size < sample.bytes.size(); ++size) {
    for (const std::size_t zeros : {std::size_t{8}, sample.bytes.size() - size, std::size_t{700}}) {
      if (zeros < 8) continue;
      setBytes(sample.folder.path(), sample.bytes.substr(0, size) + std::string(zeros, '\0'));
      const Journal journal = readJournal(sample.folder.path());
      ASSERT_EQ(journal.records.size(), kRecords - 1) << size;
      ASSERT_TRUE(journal.damage) << size;
      EXPECT_TRUE(journal.damage->is_torn_end) << size << ", " << zeros;
    }
  }
  std::string bytes = sample.bytes;
  std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(sample.begins[2]),
            bytes.begin() + static_cast<std::ptrdiff_t>(sample.begins[3]), '\0');
  setBytes(sample.folder.path(), bytes);
  EXPECT_FALSE(readJournal(sample.folder.path()).damage->is_torn_end);
  bytes = sample.bytes;
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  setBytes(sample.folder.path(), bytes);
  EXPECT_FALSE(readJournal(sample.folder.path()).damage->is_torn_end);
}

TEST(JournalReader, AFlippedBitAnywhereLosesThatRecordAndThoseBehindIt) {
  const Sample sample;
  for (std::size_t at = sample.begins[0]; at < sample.bytes.size(); ++at) {
    std::string bytes = sample.bytes;
    bytes[at] = static_cast<char>(bytes[at] ^ 4);
    setBytes(sample.folder.path(), bytes);
    const Journal journal = readJournal(sample.folder.path());
    const std::uint64_t hit = sample.recordAt(at);
    ASSERT_EQ(journal.records.size(), hit) << at;
    ASSERT_TRUE(journal.damage) << at;
    EXPECT_EQ(journal.damage->first_byte, sample.begins[hit]);
    EXPECT_EQ(journal.damage->bytes, bytes.size() - sample.begins[hit]);
    // Unless the length itself was hit, those behind can be counted.
    if (at >= sample.begins[hit] + 4) {
      EXPECT_EQ(journal.damage->records, kRecords - hit) << at;
    }
  }
}

TEST(JournalReader, ARecordThatIsMissingIsNoticed) {
  const Sample sample;
  setBytes(sample.folder.path(), sample.bytes.substr(0, sample.begins[2]) + sample.bytes.substr(sample.begins[3]));
  const Journal journal = readJournal(sample.folder.path());
  EXPECT_EQ(journal.records.size(), 2U);
  ASSERT_TRUE(journal.damage);
  EXPECT_EQ(journal.damage->reason, "record 3 is missing: 4 follows");
  EXPECT_THAT(describeDamage(*journal.damage), HasSubstr("3 records in"));
}

// Sound bytes that make no sense: written by a program with a fault, or by a later one.
TEST(JournalReader, RecordsThatMakeNoSenseEndTheJournal) {
  const Sample sample;
  const auto reasonWith = [&](const std::string& record) {
    setBytes(sample.folder.path(), sample.bytes.substr(0, sample.begins[0]) + record);
    const Journal journal = readJournal(sample.folder.path());
    EXPECT_TRUE(journal.records.empty());
    return journal.damage ? journal.damage->reason : "";
  };
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kUndo, 1, "")), "record 1 undoes what was not done");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kRedo, 1, "")), "record 1 does again what was not undone");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kUndo, 1, "x")), "record 1 holds more than an undo has");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kRedo, 1, "x")), "record 1 holds more than a redo has");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kEdit, 1, "")), "record 1 holds no commands");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kEditOn, 1, editContent({{dab(0)}}, {{0}}))),
            "record 1 goes on with what was not done");
  EXPECT_EQ(reasonWith(recordBytes(RecordKind::kStamp, 1, "xyz")), "record 1 holds no stamp");
  EXPECT_EQ(reasonWith(recordBytes(static_cast<RecordKind>(99), 1, "")), "record 1 is of a kind 99 that is not known");
}

TEST(JournalReader, SaysWhatIsLost) {
  EXPECT_EQ(describeDamage({789, 3456, 12, "record 7 is cut short"}),
            "12 records in 3456 bytes from byte 789 on, as record 7 is cut short");
  EXPECT_EQ(describeDamage({5, 1, 1, "record 2 is cut short"}),
            "1 record in 1 byte from byte 5 on, as record 2 is cut short");
}

// Every order of up to five edits, edits that go on, undos and redos against the obvious history: two stacks. What a
// session cannot have done is damage from there on, and what lasts of the rest is what lies on the stack of what is
// done.
TEST(JournalReader, TakesTheOrdersThatASessionCanHave) {
  const TemporaryFolder folder;
  const std::string header = headerBytes(sampleHeader(sampleVolume()));
  constexpr std::array kKinds = {RecordKind::kEdit, RecordKind::kUndo, RecordKind::kRedo, RecordKind::kEditOn};
  constexpr std::size_t kLength = 5;
  int damaged = 0;
  for (int order = 0; order < 1024; ++order) {  // 4^5
    std::string bytes = header, words;
    std::vector<std::pair<double, bool>> done, undone;  // and whether it goes on
    std::size_t sound = 0;
    for (std::size_t n = 0, rest = static_cast<std::size_t>(order); n < kLength; ++n, rest /= 4) {
      const RecordKind kind = kKinds[rest % 4];
      const bool goes_on = kind == RecordKind::kEditOn, is_edit = goes_on || kind == RecordKind::kEdit;
      const EditCommand command = dab(static_cast<double>(n));
      const std::uint32_t no_stamp = 0;
      bytes += recordBytes(kind, n + 1, is_edit ? editContent({&command, 1}, {&no_stamp, 1}) : "");
      words += "euro"[rest % 4];
      if (sound < n) continue;  // behind the damage
      auto& from = kind == RecordKind::kUndo ? done : undone;
      auto& to = kind == RecordKind::kUndo ? undone : done;
      if (goes_on && done.empty()) continue;
      if (is_edit) {
        done.emplace_back(static_cast<double>(n), goes_on);
        undone.clear();
      } else if (!from.empty()) {
        to.push_back(from.back());
        from.pop_back();
      } else {
        continue;
      }
      ++sound;
    }
    setBytes(folder.path(), bytes);
    const Journal journal = readJournal(folder.path());
    ASSERT_EQ(journal.records.size(), sound) << words;
    ASSERT_EQ(journal.damage.has_value(), sound < kLength) << words;
    std::vector<std::pair<double, bool>> lasting;
    for (const auto& edit : lastingEdits(journal)) lasting.emplace_back(edit.commands.at(0).from_W.x(), edit.goes_on);
    ASSERT_EQ(lasting, done) << words;
    damaged += journal.damage ? 1 : 0;
  }
  EXPECT_GT(damaged, 300);
  EXPECT_LT(damaged, 1024);
}

TEST(JournalReader, RefusesAFolderWithoutAJournal) {
  const TemporaryFolder folder;
  const auto expectRefused = [](const std::filesystem::path& place, const std::string& reason) {
    try {
      static_cast<void>(readJournal(place));
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Error::Code::kNotFound);
      EXPECT_EQ(error.what(), place.string() + ": " + reason + "; name the folder that --journal was given");
    }
  };
  expectRefused(folder.path(), "there is no journal.palpate in it");
  expectRefused(folder.path() / "none", "there is no such folder");
  std::ofstream(folder.path() / "file") << "x";
  expectRefused(folder.path() / "file", "it is no folder");
}

// A folder in the journal's place, and a file of which the system says EIO (nothing lies at a process's address 0).
TEST(JournalReader, SaysThatTheFileCannotBeRead) {
  const TemporaryFolder place, damaged;
  std::filesystem::create_directory(journalFile(place.path()));
  EXPECT_THAT(
      refusalOf([&] { static_cast<void>(readJournal(place.path())); }, Error::Code::kBadInput),
      HasSubstr("journal.palpate: it is no plain file, so it is no journal; move it away, and name the folder"));
  std::filesystem::create_symlink("/proc/self/mem", journalFile(damaged.path()));
  EXPECT_THAT(refusalOf([&] { static_cast<void>(readJournal(damaged.path())); }, Error::Code::kIo),
              HasSubstr("the journal cannot be read (Input/output error); check the disk"));
}

// It is of this moment, and nothing is said of the file.
TEST(JournalReader, SaysThatNoDescriptorIsLeft) {
  const TemporaryFolder folder;
  {
    JournalWriter writer(folder.path(), sampleHeader(sampleVolume()));
    writer.edit({{dab(0)}});
  }
  const FewDescriptors none;
  EXPECT_THAT(refusalOf([&] { static_cast<void>(readJournal(folder.path())); }, Error::Code::kOutOfMemory),
              HasSubstr("(Too many open files); raise the limit"));
}

}  // namespace journal_reader_test
}  // namespace palpate
