// SPDX-License-Identifier: Apache-2.0
// engine/journal/recovery.hpp: the volume of a session that did not come to its end, from the best of its journal and
// its checkpoints. Every program that brings edits back asks here, so all bring back the same and say the same of what
// is missing.
//
// A journal that is whole gives every edit. One that is damaged gives those before the damage, unless a checkpoint of
// this very journal (JournalHeader::id) was written after more records: then that one, and the sound records that
// follow it. A journal may itself begin with bricks, and its edits go on from these. Any thread. Cost: reads both, and
// puts bricks into the volume; the edits are left to the caller.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/journal/checkpoint.hpp"
#include "engine/journal/replay.hpp"

namespace palpate {

// In which folder the journal is that counts. A service that starts puts the journal of the one before into `earlier`
// below, until the new one holds all of it and says so by a mark. Cost: looks for two files.
[[nodiscard]] std::filesystem::path countingJournal(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path earlierFolder(const std::filesystem::path& folder);
// Where the checkpoints of the journal in `folder` are: beside it, or above `earlier`.
[[nodiscard]] std::filesystem::path checkpointFolder(const std::filesystem::path& folder);
[[nodiscard]] std::filesystem::path holdsAllMark(const std::filesystem::path& folder);

struct Recovered {
  JournalHeader header;
  Headstart held;                   // what the volume holds now
  EditMark mark;                    // of that
  std::vector<LastingEdit> before;  // the edits that it holds, in order; none where it begins_with_bricks
  std::vector<LastingEdit> edits;   // to be made after them
  std::uint64_t sequence = 0;       // of the last record that counts
  // Later ones, and the edits that a journal began with if its beginning is damaged. A record that was being written
  // when the session died is none.
  std::uint64_t lost_records = 0;
  std::string loss;  // what cannot be read, and what was done about it, in words; empty: nothing
  // Not all edits that the volume holds are known, so the journal of the next session must begin with its bricks.
  bool begins_with_bricks = false;
};

// Brings back what the journal holds, with the checkpoints of a folder (empty: without any), and puts
// what it can into `volume`, the one that the session began with (checkStart()).
[[nodiscard]] Recovered recoverSession(const Journal& journal, const std::filesystem::path& checkpoints,
                                       Volume& volume);

// Keeps a journal that was not read to its end: moves it out of the way, to a name beside it that is free
// ("journal-unread-1.palpate"), and returns that. Throws Error(kIo).
std::filesystem::path putAside(const std::filesystem::path& folder, const std::filesystem::path& into);

}  // namespace palpate
