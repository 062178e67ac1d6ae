// SPDX-License-Identifier: Apache-2.0
#include "engine/session/missing_changes.hpp"

#include <utility>

#include "engine/bricks/brick_grid.hpp"
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

void MissingChanges::makeIn(Volume& volume, const BrushProfile& profile) const {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (const Change& change : changes_) {
    if (!change.commands.empty())
      reference::applyEdits(volume, lowerEdits(change.commands, volume.size(), volume.lattice(), profile));
    for (const BrickContent& content : change.bricks) putBrick(volume, grid.brick(content.brick), content.values);
  }
}

}  // namespace palpate
