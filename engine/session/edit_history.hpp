// SPDX-License-Identifier: Apache-2.0
// engine/session/edit_history.hpp: undo and redo of an engine's edits, by copies of the bricks that they change.
//
// Memory is the only limit. If the copies exceed the budget, the oldest edits can no longer be undone. An edit whose
// copies alone exceed it is not copied; then neither that edit nor any edit before it can be undone. While an edit,
// undo or redo runs, its own copies exist in addition to the budget.
//
// Thread: the engine's. Cost of an edit: a copy of the bricks that it changes, 2 KiB a brick, 64 bytes a constant
// brick. Cost of undo and redo: that of Engine::replace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/service/engine.hpp"

namespace palpate {

// Whether an edit is undone by itself, or together with the edit before it: a stroke of the tool is many edits, and one
// for a person.
enum class UndoStep { kNew, kLast };

// What one undo takes back.
struct UndoLabel {
  EditKind kind = EditKind::kRemove;  // of its first edit
  std::uint32_t edits = 1;
};

class EditHistory {
 public:
  // Engine::allowEdits() must have been called on `engine`, which outlives this or goOnWith(). `budget_bytes`: limit
  // for all copies; 0: no undo.
  EditHistory(Engine& engine, std::size_t budget_bytes) : engine_(&engine), budget_bytes_(budget_bytes) {}

  // As Engine::edit(), and copies what the changed bricks held. Edits that were undone can no longer be redone. kLast
  // begins a step of its own where there is none to join, or where the last one was undone.
  Engine::EditResult edit(std::span<const EditCommand> commands, std::int64_t now_ns, UndoStep step = UndoStep::kNew);

  [[nodiscard]] bool canUndo() const noexcept { return done_ > 0; }
  [[nodiscard]] bool canRedo() const noexcept { return done_ < steps_.size(); }
  // These give the bricks back their former densities, bit for bit. They throw Error(kBadInput) if there is nothing to
  // undo or to redo, and as Engine::replace() does. Then the volume is as before, but its version may have grown: a
  // large undo is made in parts, and the parts done so far are reverted.
  Engine::EditResult undo(std::int64_t now_ns);
  Engine::EditResult redo(std::int64_t now_ns);
  // What they would put in place; empty: nothing.
  [[nodiscard]] std::span<const BrickContent> bricksToUndo() const noexcept;
  [[nodiscard]] std::span<const BrickContent> bricksToRedo() const noexcept;
  // From now on the edits are those of this engine, whose volume is the former one's.
  void goOnWith(Engine& engine) noexcept { engine_ = &engine; }
  // How many edits they would undo or redo; 0: none.
  [[nodiscard]] std::size_t editsToUndo() const noexcept { return canUndo() ? steps_[done_ - 1].label.edits : 0; }
  [[nodiscard]] std::size_t editsToRedo() const noexcept { return canRedo() ? steps_[done_].label.edits : 0; }

  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }         // size of the copies
  [[nodiscard]] std::size_t steps() const noexcept { return steps_.size(); }  // that can be undone or redone
  [[nodiscard]] std::size_t done() const noexcept { return done_; }           // of them, not undone
  [[nodiscard]] std::vector<UndoLabel> labels() const;                        // of all steps, the oldest first
  [[nodiscard]] std::size_t editsInEffect() const noexcept;
  // Edits that were made and can no longer be undone.
  [[nodiscard]] std::size_t forgotten() const noexcept { return forgotten_; }
  void noteForgotten(std::size_t edits) noexcept { forgotten_ += edits; }  // made before the first one here

 private:
  using Contents = std::vector<BrickContent>;
  struct Step {
    Contents bricks;  // in ascending order; what they held before its edits; of an undone step, after them
    UndoLabel label = {};
  };
  [[nodiscard]] static std::size_t bytesOf(const Step& step);
  [[nodiscard]] Contents contentOf(std::span<const std::uint32_t> bricks) const;
  void join(Contents added) noexcept;
  Engine::EditResult exchange(Step& step, std::int64_t now_ns);
  [[nodiscard]] std::size_t bytesToKeep(std::span<const std::uint32_t> bricks) const;
  void keepLast() noexcept;
  void forgetAll() noexcept;
  void forgetBeyondBudget() noexcept;

  Engine* engine_;
  std::size_t budget_bytes_;
  std::deque<Step> steps_;
  std::size_t done_ = 0;  // the first done_ steps are in effect; the others were undone
  std::size_t bytes_ = 0;
  std::size_t forgotten_ = 0;
};

}  // namespace palpate
