// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edit_session.hpp"

#include <chrono>

namespace palpate {

EditSession::EditSession(Engine& engine, const BrushProfile& profile, std::span<const EditKind> kinds,
                         std::size_t history_bytes)
    : engine_(engine), history_(engine, history_bytes) {
  engine.allowEdits(profile, kinds);
}

void EditSession::keepJournal(const std::filesystem::path& folder, const VolumeIdentity& volume,
                              JournalOptions options) {
  journal_.emplace(folder, JournalHeader{volume, engine_.editor().profile()}, std::move(options));
}

// What comes after the window is out (settling, brick by brick) is not the edit's way to the hand.
template <typename Change>
Engine::EditResult EditSession::timed(const Change& change) {
  const auto start = std::chrono::steady_clock::now();
  Engine::EditResult result = change();
  ++figures_.edits;
  if (!result.published) return result;
  double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const StageTime& stage : result.stages) seconds -= stage.name == "settle" ? stage.seconds : 0;
  ++figures_.windows;
  figures_.edit_to_window_s.push_back(seconds);
  return result;
}

Engine::EditResult EditSession::edit(std::span<const EditCommand> commands, std::int64_t now_ns) {
  Engine::EditResult result = timed([&] { return history_.edit(commands, now_ns); });
  if (journal_) journal_->edit(commands);
  return result;
}

Engine::EditResult EditSession::undo(std::int64_t now_ns) {
  Engine::EditResult result = timed([&] { return history_.undo(now_ns); });
  if (journal_) journal_->undo();
  return result;
}

Engine::EditResult EditSession::redo(std::int64_t now_ns) {
  Engine::EditResult result = timed([&] { return history_.redo(now_ns); });
  if (journal_) journal_->redo();
  return result;
}

void EditSession::close() {
  if (journal_) journal_->close();
}

EditFigures EditSession::figures() const {
  EditFigures figures = figures_;
  if (!journal_) return figures;
  figures.journalled = journal_->appended();
  figures.acknowledged = journal_->acknowledged();
  figures.journal_bytes = journal_->bytes();
  figures.journal_failure = journal_->failure();
  return figures;
}

}  // namespace palpate
