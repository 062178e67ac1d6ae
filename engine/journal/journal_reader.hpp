// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_reader.hpp: a journal as a crash left it: everything up to the first damage, and what was
// lost. Any thread. Cost: reads the file whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/journal/journal_format.hpp"

namespace palpate {

struct JournalRecord {
  RecordKind kind = RecordKind::kEdit;  // stamps are not listed: the commands have them
  std::uint64_t sequence = 0;
  std::vector<EditCommand> commands;  // of an edit
};

// What cannot be used. A record behind a damaged one is sound perhaps, but edits follow one another: without the one
// before, it would give another volume.
struct JournalDamage {
  std::uint64_t first_byte = 0;  // of the file
  std::uint64_t bytes = 0;       // from there to its end
  std::uint64_t records = 0;     // that can be made out in them, the damaged one included
  std::string reason;            // "record 7 is cut short"
};

struct Journal {
  JournalHeader header;
  std::vector<JournalRecord> records;  // in order
  std::uint64_t last_sequence = 0;     // of the last sound record, stamps included; 0: none
  std::optional<JournalDamage> damage;
};

// Throws Error: kNotFound (no such folder or no journal in it), kIo, and what readHeader refuses.
[[nodiscard]] Journal readJournal(const std::filesystem::path& folder);

// What is lost: "12 records in 3456 bytes from byte 789 on, as record 7 is cut short"
[[nodiscard]] std::string damageWords(const JournalDamage& damage);

}  // namespace palpate
