// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_reader.hpp: reads a journal as a crash left it: every record before the first damage, and a
// report of what is lost. Any thread. Cost: reads the whole file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/journal/journal_format.hpp"

namespace palpate {

struct JournalRecord {
  RecordKind kind = RecordKind::kEdit;  // an edit, undo or redo: commands hold their stamps
  std::uint64_t sequence = 0;
  std::vector<EditCommand> commands;  // of a kEdit or kEditOn record, which has some; else none
};

// The part of a journal that cannot be used by itself: the first damaged record and everything behind it. A later
// record may be sound, but without the edits before it, it would lead to a different volume.
struct JournalDamage {
  std::uint64_t first_byte = 0;     // offset in the file [byte]
  std::uint64_t bytes = 0;          // from there to the end of the file
  std::uint64_t records = 0;        // records recognised there, the damaged one included
  std::string reason;               // "record 7 is cut short"
  std::uint64_t last_sequence = 0;  // the highest number that a record there has, or must have
  bool is_of_beginning = false;     // the journal began with bricks, and these are damaged
  std::uint64_t edits_before = 0;   // that had made them, by their own damaged word; 0: that cannot be read
  // The record is the last, and its end is missing or zeros: so a session that is killed while it writes leaves it, or
  // whose power is cut. Nobody was told that it is saved.
  bool is_torn_end = false;
  // Sound records behind the damage, in order, but for those that use a stamp. A volume that a checkpoint has from
  // beyond the damage may go on with them.
  std::vector<JournalRecord> later = {};
};

// The volume that the journal begins with, where that is another one than the header's: as earlier edits made it.
struct JournalBase {
  EditMark mark;
  KeptBricks bricks;
};

struct Journal {
  std::filesystem::path file;
  JournalHeader header;
  std::optional<JournalBase> base;     // whole; one that is not is damage from the first record on
  std::vector<JournalRecord> records;  // in order
  std::uint64_t last_sequence = 0;     // of the last sound record, stamp records included; 0: none
  std::optional<JournalDamage> damage;
};

// Throws Error: kNotFound (no such folder, or no journal in it), kIo, and kBadInput as readHeader does.
[[nodiscard]] Journal readJournal(const std::filesystem::path& folder);

// The same of a file, whatever its name: one that was put aside (recovery.hpp), or brought back from a copy.
[[nodiscard]] Journal readJournalFile(const std::filesystem::path& file);

// The damage as text: "12 records in 3456 bytes from byte 789 on, as record 7 is cut short"
[[nodiscard]] std::string describeDamage(const JournalDamage& damage);

}  // namespace palpate
