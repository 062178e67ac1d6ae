// SPDX-License-Identifier: Apache-2.0
#include "engine/journal/recovery.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "base/durable_io.hpp"
#include "base/error.hpp"

namespace palpate {

namespace fs = std::filesystem;

fs::path earlierFolder(const fs::path& folder) {
  return folder / "earlier";
}

fs::path holdsAllMark(const fs::path& folder) {
  return folder / "holds-all";
}

fs::path countingJournal(const fs::path& folder) {
  std::error_code ignored;
  const bool has_earlier = fs::exists(journalFile(earlierFolder(folder)), ignored);
  return has_earlier && !fs::exists(holdsAllMark(folder), ignored) ? earlierFolder(folder) : folder;
}

fs::path checkpointFolder(const fs::path& folder) {
  return folder.filename() == earlierFolder("").filename() ? folder.parent_path() : folder;
}

namespace {

std::string recordWords(std::uint64_t count) {
  return fmt::format("{} record{}", count, count == 1 ? "" : "s");
}

// The records that follow number `sequence` one by one, as edits. `last` becomes the number of the last one that
// counts: an undo of what came before ends them.
std::vector<LastingEdit> editsAfter(std::uint64_t sequence, std::span<const JournalRecord> records,
                                    std::uint64_t& last) {
  Journal following;
  RecordOrder order;
  last = sequence;
  for (const JournalRecord& record : records) {
    if (record.sequence <= sequence) continue;
    // What a checkpoint holds can be gone on with.
    const RecordKind kind = record.kind == RecordKind::kEditOn ? RecordKind::kEdit : record.kind;
    if (record.sequence != last + 1 || !order.follow(kind)) break;
    following.records.push_back(record);
    last = record.sequence;
  }
  return lastingEdits(following);
}

// Beyond the damage: false if no checkpoint leads farther than the sound records do.
bool goBeyond(const Journal& journal, const fs::path& checkpoints, Volume& volume, Recovered& found) {
  if (checkpoints.empty()) return false;
  auto beyond = putCheckpointBeyond(checkpoints, journal.header, journal.last_sequence, volume);
  if (!beyond) return false;
  found.mark = beyond->head.mark;
  found.held = {.edits = found.mark.edits, .bricks = std::move(beyond->bricks), .good = {}};
  found.held.good[beyond->place] = found.mark;  // not to be overwritten first
  found.edits = editsAfter(beyond->head.sequence, journal.damage->later, found.sequence);
  found.begins_with_bricks = true;
  return true;
}

// The bricks that the journal begins with. Without them none of its edits can be made.
void putBase(const Journal& journal, Volume& volume, Recovered& found) {
  if (!journal.base || !fit(journal.base->bricks, volume)) return;
  putBricks(journal.base->bricks, volume);
  found.mark = journal.base->mark;
  found.held.bricks = journal.base->bricks.bricks;
  found.begins_with_bricks = true;
}

// The sound records, from the earliest checkpoint on through which they lead.
void goThrough(const Journal& journal, const fs::path& checkpoints, Volume& volume, Recovered& found) {
  putBase(journal, volume, found);
  std::vector<LastingEdit> all = lastingEdits(journal);
  Headstart held{.edits = found.mark.edits, .bricks = {}, .good = {}};
  if (!checkpoints.empty()) held = putCheckpoint(checkpoints, found.mark, all, volume);
  const auto skipped = static_cast<std::ptrdiff_t>(held.edits - found.mark.edits);
  if (held.bricks.empty()) held.bricks = std::move(found.held.bricks);
  found.held = std::move(held);
  const std::span<const LastingEdit> put(all.data(), static_cast<std::size_t>(skipped));
  const std::optional<EditMark> mark = trailAfter(found.mark, put).mark();
  if (!mark) throw std::bad_alloc();
  found.mark = *mark;
  if (!found.begins_with_bricks) found.before.assign(put.begin(), put.end());
  found.edits.assign(all.begin() + skipped, all.end());
  found.sequence = journal.last_sequence;
}

}  // namespace

Recovered recoverSession(const Journal& journal, const fs::path& checkpoints, Volume& volume) {
  Recovered found;
  found.header = journal.header;
  found.mark = *EditTrail(journal.header).mark();
  const bool is_beyond = journal.damage && goBeyond(journal, checkpoints, volume, found);
  if (!is_beyond) goThrough(journal, checkpoints, volume, found);
  if (!journal.damage) return found;
  if (journal.damage->is_torn_end && !is_beyond) {
    found.loss = fmt::format(
        "{} ends in a record that was being written when its session ended, and nobody was told "
        "that it is saved: {}",
        journal.file.string(), describeDamage(*journal.damage));
    return found;
  }
  const std::uint64_t highest = journal.damage->last_sequence;
  // Bricks stand for the edits before.
  const std::uint64_t here = journal.damage->records - (journal.damage->edits_before > 0 ? 1 : 0);
  found.lost_records =
      found.sequence == 0 ? here + journal.damage->edits_before : highest - std::min(found.sequence, highest);
  found.loss = fmt::format("{} is damaged: {}", journal.file.string(), describeDamage(*journal.damage));
  if (is_beyond)
    found.loss += fmt::format(". A checkpoint has the edits up to record {}; {} lost", found.sequence,
                              found.lost_records == 0 ? "nothing is" : recordWords(found.lost_records) + " are");
  else if (journal.damage->is_of_beginning)
    found.loss +=
        fmt::format(". It began with the volume as {} had made it, which are lost as well",
                    journal.damage->edits_before > 0 ? fmt::format("{} earlier edits", journal.damage->edits_before)
                                                     : std::string("earlier edits, nobody knows how many,"));
  const std::size_t back = found.held.edits + found.edits.size();
  found.loss += fmt::format(". {} edit{} back", back, back == 1 ? " is" : "s are");
  if (!is_beyond) found.loss += fmt::format(", {} are lost", recordWords(found.lost_records));
  return found;
}

fs::path putAside(const fs::path& folder, const fs::path& into) {
  for (int n = 1;; ++n) {
    fs::path aside = into / fmt::format("journal-unread-{}.palpate", n);
    // link() replaces nothing.
    if (link(journalFile(folder).c_str(), aside.c_str()) == 0) {
      unlink(journalFile(folder).c_str());
      const int failure = flushFolder(into);
      if (failure == 0) return aside;
      errno = failure;
    }
    if (errno == EEXIST) continue;
    throw Error(Error::Code::kIo, journalFile(folder).string(),
                fmt::format("it cannot be put aside ({})", std::strerror(errno)), "see to the rights of that folder");
  }
}

}  // namespace palpate
