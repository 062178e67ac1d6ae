// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_session.hpp: an editing session: every edit, undo and redo goes to the engine, into the history
// and into the journal, in the same order.
//
// An edit that the engine refuses is in none of them. An edit that was applied is in the journal, or the journal has
// ended and says up to where edits are saved. The volume itself is saved in the background (background_saver.hpp).
// Thread: the engine's. Cost: the engine's edit, a copy of the bricks that it changes, and an append to the journal's
// queue, which waits only where the queue is full.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/journal/journal_writer.hpp"
#include "engine/session/background_saver.hpp"
#include "engine/session/edit_history.hpp"

namespace palpate {

// Figures of a session.
struct EditFigures {
  std::uint64_t edits = 0;               // undo and redo included
  std::uint64_t windows = 0;             // edits that reached the window, so that it was published anew
  std::vector<double> edit_to_window_s;  // for each of these, the time from the call to the published window [s]
  std::uint64_t journalled = 0;          // records given to the journal
  std::uint64_t acknowledged = 0;        // records on disk
  std::uint64_t journal_bytes = 0;       // on disk; 0: there is no journal, or it was deleted because it has no record
  std::string journal_failure;           // why some records are not on disk; empty: all are, or there is no journal
  SaveFigures saves;
};

class EditSession {
 public:
  // Calls allowEdits() with these kinds on `engine`, which outlives this. `history_bytes`: memory for undo; 0: no undo.
  EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds, std::size_t history_bytes);

  // Keeps a journal in `folder` from here on. Call it before the first edit. Throws as JournalWriter does.
  void keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume, JournalOptions options = {});

  // Saves `volume`, the CPU's copy of the engine's volume as it was read back last: every `every_s` seconds if
  // something changed (0: never), and in close(). Until close() the volume belongs to the session: nobody else may look
  // at it.
  void keepSaved(Volume& volume, BackgroundSaver::Write write, double every_s);
  // Call it often. Hands changed bricks to the saver, and begins a save when one is due and the last is done. Never
  // waits for the saver. Cost: a copy of at most 256 bricks, some 1.2 us each. While a due save still lacks bricks, a
  // call also copies as many more as edits have changed since the last call; that costs a tenth of what those edits
  // took.
  void look(std::int64_t now_ns);
  [[nodiscard]] BackgroundSaver* saver() noexcept { return saver_ ? &*saver_ : nullptr; }

  // Throw as EditHistory does. After an exception other than Error it is unknown whether the volume has changed, so the
  // journal ends.
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns);
  Engine::EditResult undo(std::int64_t now_ns);
  Engine::EditResult redo(std::int64_t now_ns);

  // Waits until the journal is on disk or has failed, and ends it. Saves the volume if the newest file lacks an edit,
  // and gives the volume, with every edit in it, back to the caller. If changed bricks cannot be read from the engine,
  // the save fails.
  void close();
  // For a job that fails: ends the journal, and deletes it if it has no record, so that the job can be started again.
  void dropEmptyJournal();
  [[nodiscard]] EditFigures figures() const;
  [[nodiscard]] std::uint64_t edits() const noexcept { return figures_.edits; }  // undo and redo included
  [[nodiscard]] const EditHistory& history() const noexcept { return history_; }
  [[nodiscard]] const JournalWriter* journal() const noexcept { return journal_ ? &*journal_ : nullptr; }

 private:
  [[nodiscard]] bool isSaveDue(std::int64_t now_ns) const;
  [[nodiscard]] bool isSaved() const;
  void handOver(std::size_t most, bool save);
  template <typename Change>
  Engine::EditResult timed(const Change& change);
  template <typename Change>
  Engine::EditResult journalled(const Change& change, const std::function<void(JournalWriter&)>& append);

  Engine& engine_;
  EditHistory history_;
  std::optional<JournalWriter> journal_;
  std::optional<BackgroundSaver> saver_;
  // Bricks copied by one look(): well under a millisecond, since the engine's thread must keep the window current.
  static constexpr std::size_t kBricksAtOnce = 256;
  std::size_t left_ = 0;  // changed bricks that the last look() left, or those that changed while a file was written
  bool writing_ = false;  // the last look() began a save
  static constexpr std::int64_t kNotSet = std::numeric_limits<std::int64_t>::min();
  std::uint64_t content_version_ = 0;  // edit version of the last edit that may have changed something
  std::int64_t save_period_ns_ = 0;    // 0: no save before the end
  std::int64_t next_ns_ = kNotSet;     // when the next save is due
  bool saving_ = true;                 // changed bricks still reach the saver
  bool closed_ = false;
  EditFigures figures_;
};

}  // namespace palpate
