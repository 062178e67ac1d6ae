// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_session.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "base/error.hpp"
#include "base/stopwatch.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

constexpr std::int64_t kCopyPeriod_ns = 100'000'000;    // between two completions of the copy on the CPU
constexpr std::size_t kMostMissing = 64;                // changes that are worth one earlier
constexpr std::size_t kMostMissing_bytes = 64U << 20U;  // while a file is being written

Error lacksEdits() {
  return {Error::Code::kOutOfMemory, "the engine", "the copy of the volume on the CPU lacks edits, as memory ran out",
          "start again; the journal, if one is kept, has them"};
}

}  // namespace

EditSession::EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds,
                         std::size_t history_bytes, std::size_t edits_before)
    : engine_(&engine), profile_(profile), history_(engine, history_bytes), content_version_(edits_before) {
  engine.allowEdits(profile, kinds, edits_before);
  history_.noteForgotten(edits_before);
  figures_.edits = edits_before;
}

void EditSession::keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume, JournalOptions options,
                              const std::optional<JournalBeginning>& beginning) {
  const JournalHeader header{volume, profile_, randomId()};
  journal_id_ = header.id;
  journal_.emplace(folder, header, std::move(options), beginning);
  state_.emplace(header);
  if (beginning) state_->begin(beginning->mark, {}, beginning->bricks);
  renewal_.emplace(*journal_, *state_);
}

void EditSession::keepCheckpoints(const std::filesystem::path& folder, std::span<const LastingEdit> before,
                                  const Headstart& held, std::function<void(const std::string&)> told,
                                  double edits_between_s) {
  state_->begin(*state_->mark(), before, held.bricks);
  checkpoints_.emplace(folder, *state_, journal_id_, held, std::move(told), edits_between_s);
  if (journal_->appended() > 0) checkpoints_->journalBeganAnew();
  for (const LastingEdit& edit : before)
    journal_->edit(edit.commands, edit.goes_on ? RecordKind::kEditOn : RecordKind::kEdit);
}

// The time to the hand ends when the window is out. Settling comes after it, brick by brick, and is subtracted. Once
// the change is made nothing here throws, since the change must still go into the journal.
template <typename Change>
Engine::EditResult EditSession::timed(const Change& change) {
  const Stopwatch watch;
  Engine::EditResult result = change();
  ++figures_.edits;
  if (result.changed_bricks > 0) content_version_ = engine_->editVersion();
  if (!result.published) return result;
  double seconds = watch.seconds();
  for (const StageTime& stage : result.stages) seconds -= stage.name == "settle" ? stage.seconds : 0;
  ++figures_.windows;
  edit_to_window_s_.add(seconds);
  return result;
}

template <typename Note, typename Change>
Engine::EditResult EditSession::journalled(const Note& note, const Change& change,
                                           const std::function<void(JournalWriter&)>& append) {
  if (keeps_abreast_) note();  // before the change, after which nothing may throw
  const std::uint64_t version = engine_->editVersion();
  try {
    Engine::EditResult result = timed(change);
    if (journal_) append(*journal_);
    return result;
  } catch (const Error&) {  // nothing has changed, or the engine is broken and changes nothing more
    if (keeps_abreast_) missing_.dropLast();
    throw;
  } catch (...) {
    if (keeps_abreast_ && engine_->editVersion() == version && !engine_->broken()) missing_.dropLast();
    if (journal_) journal_->end("memory failed in the middle of an edit", ENOMEM);
    throw;
  }
}

Engine::EditResult EditSession::edit(std::span<const EditCommand> commands, std::int64_t now_ns, UndoStep step) {
  const Stopwatch watch;
  return journalled([&] { missing_.noteEdit(commands); }, [&] { return history_.edit(commands, now_ns, step); },
                    [&](JournalWriter& journal) {
                      const bool goes_on = step == UndoStep::kLast && history_.editsToUndo() > 1;
                      journal.edit(commands, goes_on ? RecordKind::kEditOn : RecordKind::kEdit);
                      state_->edited(commands, goes_on, history_.done());
                      if (checkpoints_) checkpoints_->edited(watch.seconds());
                    });
}

// A journal knows single edits, so it gets a record for each that the step holds.
Engine::EditResult EditSession::undo(std::int64_t now_ns) {
  const std::size_t edits = history_.editsToUndo();
  return journalled([&] { missing_.noteReplace(history_.bricksToUndo()); }, [&] { return history_.undo(now_ns); },
                    [&](JournalWriter& journal) {
                      for (std::size_t i = 0; i < edits; ++i) journal.undo();
                      state_->undone();
                      if (checkpoints_) checkpoints_->undone();
                    });
}

Engine::EditResult EditSession::redo(std::int64_t now_ns) {
  const std::size_t edits = history_.editsToRedo();
  return journalled([&] { missing_.noteReplace(history_.bricksToRedo()); }, [&] { return history_.redo(now_ns); },
                    [&](JournalWriter& journal) {
                      for (std::size_t i = 0; i < edits; ++i) journal.redo();
                      state_->redone();
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

void EditSession::keepAbreast() {
  keeps_abreast_ = true;
  saver_->keepWhole();
}

void EditSession::noteRenewal() noexcept {
  if (checkpoints_ && renewal_->takeBegun()) checkpoints_->journalBeganAnew();
}

bool EditSession::isCopyDue(std::int64_t now_ns) {
  if (!keeps_abreast_) return false;
  if (missing_.size() >= kMostMissing) return true;
  return now_ns >= next_copy_ns_ && (missing_.size() > 0 || (checkpoints_ && checkpoints_->isDue(now_ns)));
}

void EditSession::feedSaver(std::int64_t now_ns) {
  if (!saver_ || !saver_usable_) {
    if (journal_) journal_->failIfBehind();
    return;
  }
  const std::size_t changed = engine_->changedBricks();
  const std::size_t more = changed > bricks_left_ ? changed - bricks_left_ : 0;
  bricks_left_ = changed;
  if (!saver_->ready()) return holdBack();
  noteRenewal();
  const bool renewal_due = renewal_ && renewal_->isDue(now_ns);
  const bool copy_due = isCopyDue(now_ns) || renewal_due;
  if (save_period_ns_ == 0 && errands_.empty() && !keeps_abreast_ && !renewal_due) return;
  if (next_save_ns_ == kNotSet) next_save_ns_ = now_ns + save_period_ns_;
  // Unless there are many, bricks are handed over only once a save is due. So a brick that changes again and again is
  // copied once for each save.
  const bool save_due = save_period_ns_ > 0 && isSaveDue(now_ns), due = save_due || !errands_.empty() || copy_due;
  if (!due && changed < kBricksAtOnce) return;
  // If edits change more bricks between two calls than a call hands over, a due save would never begin. So a due save,
  // or a copy that lacks much, takes as many more as changed since the last call. Then each call shortens the list by
  // kBricksAtOnce, and the save begins.
  const Then then = renewal_due         ? Then::kNothing  // before a file, which may take minutes
                    : !errands_.empty() ? Then::kErrand
                    : save_due          ? Then::kSave
                                        : Then::kNothing;
  const bool hurries = save_due || renewal_due || !errands_.empty() || missing_.size() >= kMostMissing;
  handOver(kBricksAtOnce + (hurries ? more : 0), then, now_ns);
  bricks_left_ = engine_->changedBricks();
  if (!due || bricks_left_ > 0) return;
  if (then == Then::kSave) next_save_ns_ = now_ns + save_period_ns_;
  next_copy_ns_ = now_ns + kCopyPeriod_ns;
}

// A file takes long to write. What gathers meanwhile is taken from the engine beside it, so that it is not more than
// the volume, or not for long.
void EditSession::holdBack() {
  if (!keeps_abreast_ || missing_.bytes() < kMostMissing_bytes) return;
  std::ranges::stable_sort(held_back_, {}, &BrickContent::brick);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < held_back_.size(); ++i) {  // the newest of each brick
    if (i + 1 < held_back_.size() && held_back_[i + 1].brick == held_back_[i].brick) continue;
    if (kept != i) held_back_[kept] = std::move(held_back_[i]);
    ++kept;
  }
  held_back_.resize(kept);
  try {
    held_back_.reserve(kept + engine_->changedBricks());
    std::ranges::move(engine_->takeChanged(std::numeric_limits<std::size_t>::max()), std::back_inserter(held_back_));
    missing_.clear();
  } catch (const std::exception&) {  // nothing was taken, or the engine is broken; what is missing stays known
  }
}

// If bricks were taken from the editor and did not arrive, they would be missing in every later file. Then no file is
// written any more.
void EditSession::handOver(std::size_t most, Then then, std::int64_t now_ns) {
  try {
    if (!held_back_.empty()) return giveHeldBack();
    std::vector<BrickContent> bricks;
    if (engine_ != nullptr) bricks = engine_->takeChanged(most);
    if (state_) state_->note(bricks);
    const std::uint64_t version = engine_ != nullptr ? engine_->editVersion() : left_version_;
    const bool complete = changedBricks() == 0;
    if (complete && then == Then::kErrand) {
      saver_->give(std::move(bricks), version, std::move(errands_.front()));
      errands_.pop_front();
    } else if (complete && then == Then::kSave) {
      saver_->give(std::move(bricks), version);
    } else if (auto write = complete ? writerOf(now_ns) : nullptr) {
      saver_->give(std::move(bricks), version,
                   [write = std::move(write)](const Volume& volume, std::uint64_t) { write(volume); });
    } else {
      saver_->give(std::move(bricks),
                   complete ? BackgroundSaver::Completes::kVersion : BackgroundSaver::Completes::kNothing);
    }
    if (complete) missing_.clear();
  } catch (const std::exception& error) {
    if (keeps_abreast_ && engine_ != nullptr && engine_->broken()) return;  // the copy is completed without it
    saver_usable_ = false;
    errands_.clear();  // whoever asked is told by their end
    saver_->abandon(error.what());
  }
}

// What is to be made of the saver's volume, which holds every change: a journal that begins anew, or a checkpoint.
std::function<void(const Volume&)> EditSession::writerOf(std::int64_t now_ns) {
  if (renewal_ && renewal_->isDue(now_ns)) return renewal_->begin(now_ns, figures_.edits, history_.editsInEffect());
  if (checkpoints_ && checkpoints_->isDue(now_ns)) return checkpoints_->writer(now_ns, journal_->appended());
  return {};
}

// Whole by itself, whatever becomes of the rest.
void EditSession::giveHeldBack() {
  if (state_) state_->note(held_back_);
  saver_->give(std::exchange(held_back_, {}), BackgroundSaver::Completes::kVersion);
}

std::size_t EditSession::changedBricks() const noexcept {
  return engine_ != nullptr ? engine_->changedBricks() : 0;
}

void EditSession::leaveEngine() {
  saver_->wait();
  while (saver_usable_ && !engine_->broken() && engine_->changedBricks() > 0) {
    handOver(kBricksAtOnce, Then::kNothing, kNotSet);
    saver_->wait();
  }
  left_version_ = engine_->editVersion();
  engine_ = nullptr;
  lacks_edits_ = true;
  if (!held_back_.empty()) {
    giveHeldBack();
    saver_->wait();
  }
  Volume* const volume = saver_usable_ ? saver_->lend() : nullptr;
  if (volume == nullptr) throw lacksEdits();
  try {
    const std::vector<std::uint32_t> made = missing_.makeIn(*volume, profile_);
    if (state_) state_->note(made);
  } catch (const std::exception&) {
    throw lacksEdits();
  }
  missing_.clear();
  lacks_edits_ = false;
}

void EditSession::goOnWith(Engine& engine) {
  if (lacks_edits_) throw lacksEdits();
  engine.allowEdits(profile_, {}, left_version_);
  history_.goOnWith(engine);
  engine_ = &engine;
  bricks_left_ = 0;
}

void EditSession::close() {
  if (!saver_ || closed_) {
    if (journal_) journal_->close();
    return;
  }
  closed_ = true;
  saver_->wait();
  if (journal_) journal_->flush();  // what fails now can still begin anew
  if (renewal_) renewal_->hurry();
  if (checkpoints_) checkpoints_->hurry();
  const bool save = saves_ && !isSaved();
  for (bool more = true; more && saver_usable_ && !lacks_edits_;) {
    if (keeps_abreast_ && engine_ != nullptr && engine_->broken()) {
      try {
        leaveEngine();
      } catch (const std::exception&) {
        break;  // errands are told by their end
      }
    }
    noteRenewal();
    const bool first = !held_back_.empty() || (renewal_ && renewal_->isDue(kNotSet)) ||
                       (checkpoints_ && checkpoints_->journalIsAlone());
    const bool errand = !errands_.empty();
    handOver(kBricksAtOnce,
             first    ? Then::kNothing
             : errand ? Then::kErrand
             : save   ? Then::kSave
                      : Then::kNothing,
             kNotSet);
    saver_->wait();
    more = changedBricks() > 0 || first || errand;
  }
  saver_->close();
  errands_.clear();
  if (journal_) journal_->close();
}

bool EditSession::flushJournal() {
  return journal_ && journal_->flush();
}

void EditSession::dropEmptyJournal() {
  if (journal_) journal_->closeAndDropEmpty();
}

EditFigures EditSession::figures() const {
  EditFigures figures = figures_;
  figures.edit_to_window_s = edit_to_window_s_.inOrder();
  if (saver_) figures.saves = saver_->figures();
  // Edits after the saved version changed nothing, so the file holds the newest version.
  if (saver_ && isSaved()) figures.saves.version = engine_ != nullptr ? engine_->editVersion() : left_version_;
  if (!journal_) return figures;
  figures.journalled = journal_->appended();
  figures.acknowledged = journal_->acknowledged();
  figures.journal_bytes = journal_->bytes();
  figures.journal_failure = journal_->failure();
  return figures;
}

}  // namespace palpate
