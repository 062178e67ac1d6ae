// SPDX-License-Identifier: Apache-2.0
#include "engine/session/missing_changes.hpp"

#include <utility>

#include "engine/bricks/brick_grid.hpp"
#include "engine/edit/edit_reach.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/reference/edit.hpp"

namespace palpate {

void MissingChanges::note(Change change) {
  change.bytes = change.commands.size() * sizeof(EditCommand);
  for (const BrickContent& content : change.bricks)
    change.bytes += sizeof content + content.values.size() * sizeof(float);
  changes_.push_back(std::move(change));
  bytes_ += changes_.back().bytes;
}

void MissingChanges::noteEdit(std::span<const EditCommand> commands) {
  note({.commands = {commands.begin(), commands.end()}, .bricks = {}});
}

void MissingChanges::noteReplace(std::span<const BrickContent> bricks) {
  note({.commands = {}, .bricks = {bricks.begin(), bricks.end()}});
}

void MissingChanges::dropLast() noexcept {
  bytes_ -= changes_.back().bytes;
  changes_.pop_back();
}

void MissingChanges::clear() noexcept {
  changes_.clear();
  bytes_ = 0;
}

std::vector<std::uint32_t> MissingChanges::makeIn(Volume& volume, const BrushProfile& profile) const {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  std::vector<std::uint32_t> bricks;
  for (const Change& change : changes_) {
    if (!change.commands.empty()) {
      const LoweredEdits edits = lowerEdits(change.commands, volume.size(), volume.lattice(), profile);
      for (const layout::EditCommand& command : edits.commands) {
        const std::vector<std::uint32_t> reached = reachedBricks(command, grid);
        bricks.insert(bricks.end(), reached.begin(), reached.end());
      }
      reference::applyEdits(volume, edits);
    }
    for (const BrickContent& content : change.bricks) {
      bricks.push_back(content.brick);
      putBrick(volume, grid.brick(content.brick), content.values);
    }
  }
  return bricks;
}

}  // namespace palpate
