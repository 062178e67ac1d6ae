// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_session.hpp: an editing session: every edit, undo and redo goes to the engine, into the history
// and into the journal, in the same order.
//
// A refused edit is in none of them. An applied edit is in the journal, unless the journal has ended; then the journal
// says which edit was saved last. The volume itself is saved in the background (background_saver.hpp). A session that
// has a copy of it on the CPU (keepSaved()) begins its journal anew from that as soon as the disk takes one again.
// Thread: the engine's. Cost: the engine's edit, a copy of the bricks that it changes, and an append to the journal's
// queue. The append waits only if the queue is full.
#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/newest_values.hpp"
#include "engine/journal/journal_writer.hpp"
#include "engine/session/background_saver.hpp"
#include "engine/session/checkpoint_keeper.hpp"
#include "engine/session/edit_history.hpp"
#include "engine/session/edited_state.hpp"
#include "engine/session/journal_renewal.hpp"
#include "engine/session/missing_changes.hpp"

namespace palpate {

// Figures of a session.
struct EditFigures {
  static constexpr std::size_t kMostTimes = std::size_t{1} << 14U;  // a session may go on for days
  std::uint64_t edits = 0;                                          // undo and redo included
  std::uint64_t windows = 0;             // edits that reached the window and published it anew
  std::vector<double> edit_to_window_s;  // of the newest kMostTimes of them: from call to published window [s]
  std::uint64_t journalled = 0;          // records given to the journal
  std::uint64_t acknowledged = 0;        // records on disk
  std::uint64_t journal_bytes = 0;       // on disk; 0: no journal, or one that was deleted as it had no record
  std::string journal_failure;           // why some records are not on disk; empty: all are, or no journal
  SaveFigures saves;
};

class EditSession {
 public:
  // Calls allowEdits() with these kinds on `engine`, which outlives this or is left before. `history_bytes`: memory for
  // undo; 0: no undo. `edits_before`: that the volume holds already, of the session before this one.
  EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds, std::size_t history_bytes,
              std::size_t edits_before = 0);

  // Keeps a journal in `folder` from now on. Call it before the first edit. `beginning`: of a volume that holds edits
  // (`edits_before`) which the journal cannot have as records. Throws as JournalWriter does.
  void keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume, JournalOptions options = {},
                   const std::optional<JournalBeginning>& beginning = {});

  // Saves `volume`, the CPU's copy of the engine's volume as of the last read-back. It is saved every `every_s` seconds
  // if something changed (0: never), and in close(). Without a `write` it is never saved; the errands of ask() are
  // done. Until close() the volume belongs to the session; nobody else may touch it.
  void keepSaved(Volume& volume, BackgroundSaver::Write write, double every_s);
  // From now on the session can go on with another engine (leaveEngine()). After keepSaved(), before the first edit.
  // Cost: a copy of every brick that edits change, some ten times a second, and what MissingChanges keeps in between.
  void keepAbreast();
  [[nodiscard]] bool keepsAbreast() const noexcept { return keeps_abreast_; }
  // Writes checkpoints into `folder`, in the saver's thread. After keepJournal() and keepAbreast(), before the first
  // edit. `before`: the edits of `edits_before`, which go into the journal; none if that begins with what they made.
  // `held`: what putCheckpoint() said of them. `told`: CheckpointKeeper.
  void keepCheckpoints(const std::filesystem::path& folder, std::span<const LastingEdit> before, const Headstart& held,
                       std::function<void(const std::string&)> told,
                       double edits_between_s = CheckpointKeeper::kEditsBetween_s);
  // The engine may go, also if it has failed: then the volume of keepSaved() has every edit that was made. Waits for a
  // file that is being written. Until goOnWith() nothing else is called but close(). Throws Error(kOutOfMemory) if the
  // copy on the CPU lacks edits; then nothing but close() may be called any more.
  void leaveEngine();
  // An engine of that volume, which outlives this or is left before. Calls allowEdits(). History, journal and saves go
  // on. Throws as allowEdits() does, and as leaveEngine() did.
  void goOnWith(Engine& engine);

  // Call it often. Hands changed bricks to the saver, and begins a save once one is due and the last is done. Never
  // waits for the saver. Cost: a copy of at most 256 bricks, some 1.2 us each. If a due save still lacks bricks, a call
  // also copies as many as edits have changed since the last call. That takes a tenth of the time of those edits. While
  // a file is being written, a session that keeps abreast copies all once 64 MiB of changes are missing.
  void feedSaver(std::int64_t now_ns);
  // To be done with the volume as it is once feedSaver() has handed over every edit made until now; after keepSaved().
  // Errands are done in order, in the saver's thread, while edits go on. close() does those that are left.
  void ask(BackgroundSaver::Errand errand) {
    if (saver_usable_) errands_.push_back(std::move(errand));
  }
  [[nodiscard]] BackgroundSaver* saver() noexcept { return saver_ ? &*saver_ : nullptr; }

  // These throw as EditHistory does. After an exception other than Error it is unknown whether the volume has changed,
  // so the journal ends.
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns, UndoStep step = UndoStep::kNew);
  Engine::EditResult undo(std::int64_t now_ns);
  Engine::EditResult redo(std::int64_t now_ns);

  // Waits until the journal is on disk or has failed, and ends it. Saves the volume if the newest file lacks an edit.
  // Then the volume, with every edit in it, belongs to the caller again. If changed bricks cannot be read from the
  // engine, the save fails.
  void close();
  // Waits until the journal is on disk or has failed. Returns whether it holds every edit made until now.
  bool flushJournal();
  // For a job that fails. Ends the journal, and deletes it if it has no record, so that the job can be started again.
  void dropEmptyJournal();
  [[nodiscard]] EditFigures figures() const;
  [[nodiscard]] std::uint64_t edits() const noexcept { return figures_.edits; }  // undo and redo included
  // Engine::editVersion() of the last edit, undo or redo that may have changed something; 0: none.
  [[nodiscard]] std::uint64_t contentVersion() const noexcept { return content_version_; }
  [[nodiscard]] const EditHistory& history() const noexcept { return history_; }
  [[nodiscard]] const JournalWriter* journal() const noexcept { return journal_ ? &*journal_ : nullptr; }

 private:
  [[nodiscard]] bool isSaveDue(std::int64_t now_ns) const;
  [[nodiscard]] bool isCopyDue(std::int64_t now_ns);
  void noteRenewal() noexcept;  // when the saver is ready
  [[nodiscard]] bool isSaved() const;
  [[nodiscard]] std::size_t changedBricks() const noexcept;  // that the copy lacks
  enum class Then { kNothing, kSave, kErrand };              // once no changed brick is left
  void handOver(std::size_t most, Then then, std::int64_t now_ns);
  void giveHeldBack();
  void holdBack();
  [[nodiscard]] std::function<void(const Volume&)> writerOf(std::int64_t now_ns);
  template <typename Change>
  Engine::EditResult timed(const Change& change);
  template <typename Note, typename Change>
  Engine::EditResult journalled(const Note& note, const Change& change,
                                const std::function<void(JournalWriter&)>& append);

  Engine* engine_;  // null: it has been left
  BrushProfile profile_;
  EditHistory history_;
  std::uint64_t journal_id_ = 0;
  std::optional<JournalWriter> journal_;
  std::optional<EditedState> state_;  // if there is a journal; this and the next two before the saver, which uses them
  std::optional<JournalRenewal> renewal_;  // the same
  std::optional<CheckpointKeeper> checkpoints_;
  std::optional<BackgroundSaver> saver_;
  // Most bricks that one feedSaver() copies: well under a millisecond, since the engine's thread must keep the window
  // current.
  static constexpr std::size_t kBricksAtOnce = 256;
  // Changed bricks that the last feedSaver() left.
  std::size_t bricks_left_ = 0;
  bool keeps_abreast_ = false, lacks_edits_ = false;
  std::vector<BrickContent> held_back_;  // taken from the engine, and not yet given to the saver
  MissingChanges missing_;               // if it keeps abreast
  std::int64_t next_copy_ns_ = 0;        // when the copy is to be completed next
  std::uint64_t left_version_ = 0;       // of the engine that was left
  std::deque<BackgroundSaver::Errand> errands_;
  static constexpr std::int64_t kNotSet = std::numeric_limits<std::int64_t>::min();
  std::uint64_t content_version_ = 0;    // edit version of the last edit that may have changed something
  bool saves_ = false;                   // a file is to be kept
  std::int64_t save_period_ns_ = 0;      // 0: no save before the end
  std::int64_t next_save_ns_ = kNotSet;  // when the next save is due
  bool saver_usable_ = true;             // changed bricks still reach the saver
  bool closed_ = false;
  EditFigures figures_;
  NewestValues edit_to_window_s_{EditFigures::kMostTimes};
};

}  // namespace palpate
