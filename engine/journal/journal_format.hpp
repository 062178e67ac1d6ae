// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_format.hpp: what a journal says, and how it is written as bytes: docs/journal.md. Any thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/journal/volume_identity.hpp"

namespace palpate {

inline constexpr std::string_view kJournalMagic = "PALPJRNL";
inline constexpr std::uint32_t kJournalVersion = 2;
inline constexpr const char* kJournalName = "journal.palpate";  // in its folder
[[nodiscard]] inline std::filesystem::path journalFile(const std::filesystem::path& folder) {
  return folder / kJournalName;
}

struct JournalHeader {
  VolumeIdentity volume;  // before the first edit
  BrushProfile profile;   // what every edit is lowered with
};

enum class RecordKind : std::uint32_t {
  kEdit = 1,   // commands of one apply()
  kUndo = 2,   // of the last edit that is not undone
  kRedo = 3,   // of the last edit that is
  kStamp = 4,  // a mesh that later commands name by its number
};

inline constexpr std::size_t kRecordHead = 16;                // length, kind, sequence number
inline constexpr std::size_t kRecordFrame = kRecordHead + 4;  // and checksum
inline constexpr std::uint32_t kLongestRecord = 1U << 30U;    // of its content [byte]

// A command's: flatten's, with all that can be set. An edit of as many as there may be is shorter than a record's most.
inline constexpr std::size_t kLongestCommand = 154;  // [byte]

[[nodiscard]] std::string headerBytes(const JournalHeader& header);
[[nodiscard]] std::string recordBytes(RecordKind kind, std::uint64_t sequence, std::string_view content);

// A command without its stamp, which goes by `stamp_number` (0: it has none).
[[nodiscard]] std::string editContent(std::span<const EditCommand> commands,
                                      std::span<const std::uint32_t> stamp_numbers);
[[nodiscard]] std::string stampContent(const Stamp& stamp);

// Null, or nothing, where the bytes are no such thing. `stamps`: those read so far, number 1 first.
[[nodiscard]] std::optional<std::vector<EditCommand>> editOf(std::string_view content,
                                                             std::span<const std::shared_ptr<const Stamp>> stamps);
[[nodiscard]] std::shared_ptr<const Stamp> stampOf(std::string_view content);

// Takes the header off the front of a journal's bytes; returns how many it has. Throws Error(kBadInput) naming `input`:
// no journal, a journal of another version, a damaged header.
[[nodiscard]] std::size_t readHeader(std::string_view bytes, const std::string& input, JournalHeader& header);

}  // namespace palpate
