// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_history.hpp: undo and redo of an engine's edits, by copies of the bricks that they change.
//
// Limited by memory alone: where the copies exceed the budget, the oldest edits can no longer be undone. An edit whose
// copies alone would exceed it cannot be undone at all, and neither can those before it; it is not copied in the first
// place. While an edit, undo or redo runs, its own copies are there beside the others. Thread: the engine's. Cost of an
// edit: a copy of what it changes, 2 KiB a brick, 64 bytes one that is constant; of undo and redo: as Engine::replace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/service/engine.hpp"

namespace palpate {

class EditHistory {
 public:
  // `engine` has had its edits allowed and outlives this. `budget_bytes`: of all copies.
  EditHistory(Engine& engine, std::size_t budget_bytes) : engine_(engine), budget_bytes_(budget_bytes) {}

  // As Engine::edit, with its bricks kept. What was undone before can no longer be done again.
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns);

  [[nodiscard]] bool canUndo() const noexcept { return done_ > 0; }
  [[nodiscard]] bool canRedo() const noexcept { return done_ < steps_.size(); }
  // Each refuses (Error kBadInput) where there is nothing to undo or to do again. Bit for bit what was there. Throws as
  // Engine::replace does; then the volume is as before, although several versions on where parts had to be put back.
  Engine::EditResult undo(std::int64_t now_ns);
  Engine::EditResult redo(std::int64_t now_ns);

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }         // of the copies
  [[nodiscard]] std::size_t steps() const noexcept { return steps_.size(); }  // that can be undone or done again
  // Edits that were made and can no longer be undone.
  [[nodiscard]] std::size_t forgotten() const noexcept { return forgotten_; }

 private:
  using Step = std::vector<BrickContent>;  // what the bricks held before it; after an undo, what after
  [[nodiscard]] Step contentOf(const std::vector<std::uint32_t>& bricks) const;
  Engine::EditResult exchange(Step& step, std::int64_t now_ns);
  [[nodiscard]] std::size_t bytesToKeep(const std::vector<std::uint32_t>& bricks) const;
  void keepLast() noexcept;
  void forgetAll() noexcept;
  void forgetBeyondBudget() noexcept;

  Engine& engine_;
  std::size_t budget_bytes_;
  std::deque<Step> steps_;
  std::size_t done_ = 0;  // of the steps; those behind it were undone
  std::size_t bytes_ = 0;
  std::size_t forgotten_ = 0;
};

}  // namespace palpate
