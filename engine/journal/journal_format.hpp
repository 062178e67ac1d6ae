// SPDX-License-Identifier: Apache-2.0
// engine/journal/journal_format.hpp: the records of a journal and their encoding as bytes (docs/journal.md). Any
// thread.
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
#include "engine/journal/kept_bricks.hpp"
#include "engine/journal/volume_identity.hpp"

namespace palpate {

inline constexpr std::string_view kJournalMagic = "PALPJRNL";
inline constexpr std::uint32_t kJournalVersion = 4;
inline constexpr std::uint32_t kOldestJournalVersion = 2;       // that is read, too
inline constexpr const char* kJournalName = "journal.palpate";  // in the journal's folder
[[nodiscard]] inline std::filesystem::path journalFile(const std::filesystem::path& folder) {
  return folder / kJournalName;
}

struct JournalHeader {
  VolumeIdentity volume;  // before the first edit
  BrushProfile profile;   // the density profile of every edit (engine/edit/lower_edit.hpp)
  std::uint64_t id = 0;   // of this journal alone, so that a checkpoint can say whose it is; 0: of an older version
};

// Names a state of a session's volume, as EditTrail makes it.
struct EditMark {
  std::uint64_t edits = 0;  // in effect
  std::uint64_t hash = 0;
  bool operator==(const EditMark&) const = default;
};

// For an id or a hash that no other journal or state has. Never 0.
[[nodiscard]] std::uint64_t randomId();

enum class RecordKind : std::uint32_t {
  kEdit = 1,    // the commands of one Editor::apply()
  kUndo = 2,    // undoes the last edit that is in effect
  kRedo = 3,    // redoes the edit that was undone last
  kStamp = 4,   // a mesh, which later commands name by its number
  kEditOn = 5,  // as kEdit, of a person's stroke that goes on: undone together with the edit before it
  kBricks = 6,  // what edits before this journal have made of the volume; only at its beginning, one or several
};

[[nodiscard]] constexpr bool isRecordKind(std::uint32_t kind) noexcept {
  return kind >= static_cast<std::uint32_t>(RecordKind::kEdit) &&
         kind <= static_cast<std::uint32_t>(RecordKind::kBricks);
}

// Which edits, undos and redos can follow one another in a journal: an undo takes back an edit that the journal has, a
// redo makes one again that was undone since the last edit.
class RecordOrder {
 public:
  // Whether a record of this kind can come next; if so, it has come.
  [[nodiscard]] bool follow(RecordKind kind) noexcept;
  [[nodiscard]] std::uint64_t done() const noexcept { return done_; }  // edits in effect

 private:
  std::uint64_t done_ = 0, undone_ = 0;
};

inline constexpr std::size_t kRecordHead = 16;                // length, kind, sequence number [byte]
inline constexpr std::size_t kRecordFrame = kRecordHead + 4;  // the head and the checksum [byte]
inline constexpr std::uint32_t kLongestRecord = 1U << 30U;    // limit of a record's content [byte]

// The longest encoding of a command: a flatten with everything set. One record has room for kMaxCommands of these.
inline constexpr std::size_t kLongestCommand = 154;  // [byte]

[[nodiscard]] std::string headerBytes(const JournalHeader& header);
[[nodiscard]] std::string recordBytes(RecordKind kind, std::uint64_t sequence, std::string_view content);

// The content of an edit's record. `stamp_numbers` has one entry for each command: the number of its stamp's record, or
// 0 if it has no stamp.
[[nodiscard]] std::string editContent(std::span<const EditCommand> commands,
                                      std::span<const std::uint32_t> stamp_numbers);
[[nodiscard]] std::string stampContent(const Stamp& stamp);
// Of bricks of `volume`; `is_last`: of those that the journal begins with.
[[nodiscard]] std::string bricksContent(const EditMark& mark, bool is_last, const Volume& volume,
                                        std::span<const std::uint32_t> bricks);

// These decode a record's content. The result is empty or null if the content is malformed. `stamps`: those read so
// far, number 1 first.
[[nodiscard]] std::optional<std::vector<EditCommand>> editOf(std::string_view content,
                                                             std::span<const std::shared_ptr<const Stamp>> stamps);
[[nodiscard]] std::shared_ptr<const Stamp> stampOf(std::string_view content);

struct BricksRecord {
  EditMark mark;
  bool is_last = false;
};
// The bricks go to those that are there.
[[nodiscard]] std::optional<BricksRecord> bricksOf(std::string_view content, KeptBricks& bricks);
// How many edits made these bricks, as the front of the content says, even if the rest is damaged.
[[nodiscard]] std::uint64_t editsOfBricks(std::string_view content);

// Decodes the header at the front of a journal's bytes. Returns the header's length [byte]. Throws Error(kBadInput),
// naming `input`, if the bytes are no journal, are a journal of another version, or have a damaged header.
[[nodiscard]] std::size_t readHeader(std::string_view bytes, const std::string& input, JournalHeader& header);

}  // namespace palpate
