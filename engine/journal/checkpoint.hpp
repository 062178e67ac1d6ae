// SPDX-License-Identifier: Apache-2.0
// engine/journal/checkpoint.hpp: what edits have made of a volume until some moment, as a file beside the journal. A
// session that comes back after a crash puts it into the volume and makes only the later edits again.
//
// A checkpoint is no promise: the journal alone has everything. One that is missing, damaged, or of edits that were
// undone since costs time, nothing else. Two are kept, and the earlier one is used, so that the edits between it and
// the end can be undone. Where the journal is damaged, one that says it is of this journal reaches beyond the damage
// (recovery.hpp). Format: docs/journal.md. Any thread, one at a time for a folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "engine/journal/edit_trail.hpp"
#include "engine/journal/replay.hpp"

namespace palpate {

inline constexpr std::size_t kCheckpoints = 2;
using CheckpointMarks = std::array<std::optional<EditMark>, kCheckpoints>;
[[nodiscard]] std::filesystem::path checkpointFile(const std::filesystem::path& folder, std::size_t number);

// Free space that a checkpoint of so many bricks is written with [byte]: twice its size, and 64 MiB. A journal that
// finds no room ends, so a checkpoint is not to take the last.
[[nodiscard]] std::uint64_t roomFor(std::size_t bricks) noexcept;
// Throws Error(kIo) if the folder's disk has less; where the system does not say, it has enough.
void checkRoomFor(const std::filesystem::path& folder, std::size_t bricks);

// Of which state a checkpoint is.
struct CheckpointHead {
  EditMark mark;
  std::uint64_t journal = 0;   // JournalHeader::id of the session's
  std::uint64_t sequence = 0;  // of its newest record then
};

// Writes what `bricks` (page indices, ascending) hold in `volume`, whole or not at all. Throws Error(kIo). Cost: 2 KiB
// for each brick, and waiting for the disk.
void writeCheckpoint(const std::filesystem::path& file, const CheckpointHead& head, const Volume& volume,
                     std::span<const std::uint32_t> bricks);

// A volume as the first edits of a journal made it.
struct Headstart {
  std::size_t edits = 0;              // that it holds
  std::vector<std::uint32_t> bricks;  // that they may have changed, ascending
  CheckpointMarks good;               // of the files, as far as these edits lead through them
};
// Puts the earliest checkpoint of `edits` into `volume`, with which the journal begins: `start` is the mark of that
// volume. Without one: no edit, and the volume is as it was. `edits` of the result counts those of `start`.
[[nodiscard]] Headstart putCheckpoint(const std::filesystem::path& folder, const EditMark& start,
                                      std::span<const LastingEdit> edits, Volume& volume);

// Puts the newest checkpoint that is of this journal, after `sequence`, into `volume`. Empty: there is none, and the
// volume is as it was.
struct BeyondDamage {
  CheckpointHead head;
  std::size_t place = 0;              // of the file
  std::vector<std::uint32_t> bricks;  // that edits may have changed, ascending
};
[[nodiscard]] std::optional<BeyondDamage> putCheckpointBeyond(const std::filesystem::path& folder,
                                                              const JournalHeader& header, std::uint64_t sequence,
                                                              Volume& volume);

void removeCheckpoints(const std::filesystem::path& folder) noexcept;

}  // namespace palpate
