// SPDX-License-Identifier: Apache-2.0
#include "engine/session/missing_changes.hpp"

#include "engine/bricks/brick_grid.hpp"
#include "engine/edit/lower_edit.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/reference/edit.hpp"

namespace palpate {

void MissingChanges::makeIn(Volume& volume, const BrushProfile& profile) const {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (const Change& change : changes_) {
    if (!change.commands.empty())
      reference::applyEdits(volume, lowerEdits(change.commands, volume.size(), volume.lattice(), profile));
    for (const BrickContent& content : change.bricks) putBrick(volume, grid.brick(content.brick), content.values);
  }
}

}  // namespace palpate
