// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_session.hpp: an editing session: every edit, undo and redo goes to the engine, into the history
// and into the journal, in one order. An edit that the engine refuses is in none of them. The volume itself is saved
// beside it (background_saver.hpp). An edit that was applied is in the journal, or the journal has ended and says up to
// where edits are saved. Thread: the engine's.
// Cost: the engine's edit, a copy of the bricks that it changes, and an append to the journal's queue, which waits
// only where the queue is full.
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

// What a session can say of itself afterwards.
struct EditFigures {
  std::uint64_t edits = 0;               // undo and redo included
  std::uint64_t windows = 0;             // edits that reached the window and published it anew
  std::vector<double> edit_to_window_s;  // of those: from the call to the published window [s]
  std::uint64_t journalled = 0;          // records given to the journal
  std::uint64_t acknowledged = 0;        // of those, on disk
  std::uint64_t journal_bytes = 0;
  std::string journal_failure;  // why not all are; empty: they are, or there is no journal
  SaveFigures saves;
};

class EditSession {
 public:
  // Allows edits of these kinds on `engine`, which outlives this. `history_bytes`: 0: no undo.
  EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds, std::size_t history_bytes);

  // From here on edits are kept in a journal in `folder`; before the first. Throws as JournalWriter does.
  void keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume, JournalOptions options = {});

  // From here on `volume`, the engine's own as it was read back last, belongs to the session until close(): nobody else
  // may look at it. It is saved every `every_s` seconds in which something changed (0: never), and by close().
  void keepSaved(Volume& volume, BackgroundSaver::Write write, double every_s);
  // Often: hands over what changed, and begins a save when one is due and the last is done. Never waits for the saver.
  // Cost: a copy of 256 bricks at most, some 1.2 us each; while a due save waits for its last bricks, of as many more
  // as edits have changed since bricks were handed over last: a tenth of what those edits took.
  void look(std::int64_t now_ns);
  [[nodiscard]] BackgroundSaver* saver() noexcept { return saver_ ? &*saver_ : nullptr; }

  // Throw as EditHistory does. Where that is no Error nobody knows whether the volume has changed: the journal ends.
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns);
  Engine::EditResult undo(std::int64_t now_ns);
  Engine::EditResult redo(std::int64_t now_ns);

  // Waits until the journal is on disk or has failed, and ends it. Saves what no file holds yet, and gives the volume
  // back, with every edit in it; where what changed can no longer be had from the engine, that is a failed save.
  void close();
  // Where a job fails: ends the journal, and one without a record is gone, so that the job can be begun again.
  void dropEmptyJournal();
  [[nodiscard]] EditFigures figures() const;
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
  // Copied in one go, in well under a millisecond: the engine's thread has the window to see to.
  static constexpr std::size_t kBricksAtOnce = 256;
  std::size_t left_ =
      0;  // changed bricks that were not handed over last time, or that changed while a file was written
  bool writing_ = false;  // the last hand-over began a save
  static constexpr std::int64_t kNotSet = std::numeric_limits<std::int64_t>::min();
  std::uint64_t content_version_ = 0;  // of the last edit that may have changed something
  std::int64_t save_period_ns_ = 0;    // 0: no save before the end
  std::int64_t next_ns_ = kNotSet;     // when the next save is due
  bool saving_ = true;                 // what changed still reaches the saver
  bool closed_ = false;
  EditFigures figures_;
};

}  // namespace palpate
