// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_session.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"

namespace palpate {

EditSession::EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds,
                         std::size_t history_bytes)
    : engine_(engine), history_(engine, history_bytes) {
  engine.allowEdits(profile, kinds);
}

void EditSession::keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume,
                              JournalOptions options) {
  journal_.emplace(folder, JournalHeader{volume, engine_.profile()}, std::move(options));
}

// The time to the hand ends when the window is out. Settling comes after it, brick by brick, and is subtracted. Once
// the change is made nothing here throws, since the change must still go into the journal.
template <typename Change>
Engine::EditResult EditSession::timed(const Change& change) {
  std::vector<double>& times = figures_.edit_to_window_s;
  if (times.size() == times.capacity()) times.reserve(std::max<std::size_t>(1024, 2 * times.size()));
  const Stopwatch watch;
  Engine::EditResult result = change();
  ++figures_.edits;
  if (result.changed_bricks > 0) content_version_ = engine_.editVersion();
  if (!result.published) return result;
  double seconds = watch.seconds();
  for (const StageTime& stage : result.stages) seconds -= stage.name == "settle" ? stage.seconds : 0;
  ++figures_.windows;
  times.push_back(seconds);
  return result;
}

template <typename Change>
Engine::EditResult EditSession::journalled(const Change& change, const std::function<void(JournalWriter&)>& append) {
  try {
    Engine::EditResult result = timed(change);
    if (journal_) append(*journal_);
    return result;
  } catch (const Error&) {  // nothing has changed, or the engine is broken and changes nothing more
    throw;
  } catch (...) {
    if (journal_) journal_->end("memory failed in the middle of an edit", ENOMEM);
    throw;
  }
}

Engine::EditResult EditSession::edit(std::span<const EditCommand> commands, std::int64_t now_ns, UndoStep step) {
  return journalled([&] { return history_.edit(commands, now_ns, step); },
                    [&](JournalWriter& journal) { journal.edit(commands); });
}

// A journal knows single edits, so it gets a record for each that the step holds.
Engine::EditResult EditSession::undo(std::int64_t now_ns) {
  const std::size_t edits = history_.editsToUndo();
  return journalled([&] { return history_.undo(now_ns); },
                    [&](JournalWriter& journal) {
                      for (std::size_t i = 0; i < edits; ++i) journal.undo();
                    });
}

Engine::EditResult EditSession::redo(std::int64_t now_ns) {
  const std::size_t edits = history_.editsToRedo();
  return journalled([&] { return history_.redo(now_ns); },
                    [&](JournalWriter& journal) {
                      for (std::size_t i = 0; i < edits; ++i) journal.redo();
                    });
}

void EditSession::keepSaved(Volume& volume, BackgroundSaver::Write write, double every_s) {
  save_period_ns_ = std::llround(every_s * kNanosecondsPerSecond);
  saves_ = static_cast<bool>(write);
  saver_.emplace(volume, std::move(write));
}

// A save is due only if something changed since the last successful save.
bool EditSession::isSaveDue(std::int64_t now_ns) const {
  return now_ns >= next_save_ns_ && content_version_ > 0 && !isSaved();
}

bool EditSession::isSaved() const {
  const std::optional<std::uint64_t> saved = saver_->savedVersion();
  return saved && *saved >= content_version_;
}

void EditSession::feedSaver(std::int64_t now_ns) {
  if (!saver_ || !saver_usable_ || (save_period_ns_ == 0 && errands_.empty()) || !saver_->ready()) return;
  if (next_save_ns_ == kNotSet) next_save_ns_ = now_ns + save_period_ns_;
  const std::size_t changed = engine_.changedBricks();
  if (std::exchange(save_begun_, false)) bricks_left_ = changed;
  // Unless there are many, bricks are handed over only once a save is due. So a brick that changes again and again is
  // copied once for each save.
  const bool save_due = save_period_ns_ > 0 && isSaveDue(now_ns), due = save_due || !errands_.empty();
  if (!due && changed < kBricksAtOnce) return;
  // If edits change more bricks between two calls than a call hands over, a due save would never begin. So a due save
  // takes as many more as changed since the last call. Then each call shortens the list by kBricksAtOnce, and the save
  // begins.
  const Then then = !errands_.empty() ? Then::kErrand : save_due ? Then::kSave : Then::kNothing;
  handOver(kBricksAtOnce + (due && changed > bricks_left_ ? changed - bricks_left_ : 0), then);
  bricks_left_ = engine_.changedBricks();
  if (!due || bricks_left_ > 0) return;
  if (then == Then::kSave) next_save_ns_ = now_ns + save_period_ns_;
  save_begun_ = true;
}

// If bricks were taken from the editor and did not arrive, they would be missing in every later file. Then no file is
// written any more.
void EditSession::handOver(std::size_t most, Then then) {
  try {
    std::vector<BrickContent> bricks = engine_.takeChanged(most);
    const bool complete = engine_.changedBricks() == 0;
    if (complete && then == Then::kErrand) {
      saver_->give(std::move(bricks), engine_.editVersion(), std::move(errands_.front()));
      errands_.pop_front();
    } else {
      const bool save = complete && then == Then::kSave;
      saver_->give(std::move(bricks), save ? std::optional(engine_.editVersion()) : std::nullopt);
    }
  } catch (const std::exception& error) {
    saver_usable_ = false;
    errands_.clear();  // whoever asked is told by their end
    saver_->abandon(error.what());
  }
}

void EditSession::close() {
  if (journal_) journal_->close();
  if (!saver_ || closed_) return;
  closed_ = true;
  saver_->wait();
  const bool save = saves_ && !isSaved();
  for (bool more = true; more && saver_usable_;) {
    const bool errand = !errands_.empty();
    handOver(kBricksAtOnce, errand ? Then::kErrand : save ? Then::kSave : Then::kNothing);
    saver_->wait();
    more = engine_.changedBricks() > 0 || errand;
  }
  saver_->close();
  errands_.clear();
}

bool EditSession::flushJournal() {
  if (!journal_) return false;
  journal_->flush();
  return !journal_->failed();
}

void EditSession::dropEmptyJournal() {
  if (journal_) journal_->closeAndDropEmpty();
}

EditFigures EditSession::figures() const {
  EditFigures figures = figures_;
  if (saver_) figures.saves = saver_->figures();
  // Edits after the saved version changed nothing, so the file holds the newest version.
  if (saver_ && isSaved()) figures.saves.version = engine_.editVersion();
  if (!journal_) return figures;
  figures.journalled = journal_->appended();
  figures.acknowledged = journal_->acknowledged();
  figures.journal_bytes = journal_->bytes();
  figures.journal_failure = journal_->failure();
  return figures;
}

}  // namespace palpate
