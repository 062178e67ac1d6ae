// SPDX-License-Identifier: Apache-2.0
// engine/session/missing_changes.hpp: edits, undo and redo that the CPU's copy of a volume does not hold yet, so that
// it can be completed when the engine, which held them, has failed.
//
// Thread: the session's. Memory: the commands of edits, and copies of the bricks that undo and redo put in place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "engine/edit/brush_profile.hpp"
#include "engine/edit/edit_command.hpp"
#include "engine/field/volume.hpp"
#include "engine/service/brick_content.hpp"

namespace palpate {

class MissingChanges {
 public:
  void noteEdit(std::span<const EditCommand> commands);
  void noteReplace(std::span<const BrickContent> bricks);
  void dropLast() noexcept;  // it was not made
  void clear() noexcept;     // the copy holds them
  [[nodiscard]] std::size_t size() const noexcept { return changes_.size(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }  // of commands and bricks

  // Makes them in a copy that lacks these alone, as the CPU twin of the brushes does: bit for bit what the engine held.
  // Returns the bricks that it may have changed, some of them more than once.
  std::vector<std::uint32_t> makeIn(Volume& volume, const BrushProfile& profile) const;

 private:
  struct Change {  // one of the two
    std::vector<EditCommand> commands;
    std::vector<BrickContent> bricks;
    std::size_t bytes = 0;
  };
  void note(Change change);

  std::deque<Change> changes_;
  std::size_t bytes_ = 0;
};

}  // namespace palpate
