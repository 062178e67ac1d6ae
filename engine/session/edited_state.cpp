// SPDX-License-Identifier: Apache-2.0
#include "engine/session/edited_state.hpp"

#include "engine/bricks/brick_grid.hpp"

namespace palpate {

EditedState::EditedState(const JournalHeader& header)
    : trail_(header), is_changed_(BrickGrid{header.volume.size, header.volume.lattice.spacing_m}.brickCount()) {}

void EditedState::begin(const EditMark& start, std::span<const LastingEdit> edits,
                        std::span<const std::uint32_t> bricks) {
  trail_ = trailAfter(start, edits);
  note(bricks);
}

void EditedState::edited(std::span<const EditCommand> commands, bool goes_on, std::size_t undoable) noexcept {
  trail_.edit(commands, goes_on);
  trail_.forgetAllBut(undoable);
}

void EditedState::note(std::span<const BrickContent> bricks) noexcept {
  for (const BrickContent& content : bricks) is_changed_[content.brick] = true;
}

void EditedState::note(std::span<const std::uint32_t> bricks) noexcept {
  for (const std::uint32_t brick : bricks) is_changed_[brick] = true;
}

EditMark EditedState::markAnyway(std::size_t edits) {
  if (!trail_.mark()) trail_ = EditTrail(EditMark{edits, randomId()});
  return *trail_.mark();
}

std::vector<std::uint32_t> EditedState::bricks() const {
  std::vector<std::uint32_t> bricks;
  for (std::size_t i = 0; i < is_changed_.size(); ++i) {
    if (is_changed_[i]) bricks.push_back(static_cast<std::uint32_t>(i));
  }
  return bricks;
}

}  // namespace palpate
