// SPDX-License-Identifier: Apache-2.0
// engine/session/edited_state.hpp: what the edits of a session have made of its volume: a name for the present state,
// and the bricks that may differ from the volume at the start. A checkpoint and a journal that begins anew hold these.
//
// Thread: the engine's; bricks() by the saver's, while no brick is noted. Memory: a bit for each brick of the volume,
// and the marks of the steps that can be undone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/journal/edit_trail.hpp"
#include "engine/journal/replay.hpp"
#include "engine/service/brick_content.hpp"

namespace palpate {

class EditedState {
 public:
  explicit EditedState(const JournalHeader& header);
  // The volume holds `edits` already, which were made from `start` on, and may differ in `bricks`. Before all else.
  void begin(const EditMark& start, std::span<const LastingEdit> edits, std::span<const std::uint32_t> bricks);

  // Every change that was made, in order. `undoable`: EditHistory::done() after it.
  void edited(std::span<const EditCommand> commands, bool goes_on, std::size_t undoable) noexcept;
  void undone() noexcept { trail_.undo(); }
  void redone() noexcept { trail_.redo(); }
  // Bricks that the saver's volume gets, whoever changed them.
  void note(std::span<const BrickContent> bricks) noexcept;
  void note(std::span<const std::uint32_t> bricks) noexcept;

  // Empty: memory failed for a name.
  [[nodiscard]] std::optional<EditMark> mark() const noexcept { return trail_.mark(); }
  // The same, with a new random name where there is none. `edits`: in effect.
  [[nodiscard]] EditMark markAnyway(std::size_t edits);
  [[nodiscard]] std::vector<std::uint32_t> bricks() const;  // ascending

 private:
  EditTrail trail_;
  std::vector<bool> is_changed_;
};

}  // namespace palpate
