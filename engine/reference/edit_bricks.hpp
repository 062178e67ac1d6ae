// SPDX-License-Identifier: Apache-2.0
// engine/reference/edit_bricks.hpp: the twin of the edit kernels on a volume's bricks: only those that a command can
// reach are visited, so that long lists of edits can be replayed. Bits: those of reference/edit.hpp and of the kernels.
// Any thread, while nobody else uses the volume. Cost: some 10 us a brick and command.
#pragma once

#include "engine/edit/lower_edit.hpp"
#include "engine/volume/volume.hpp"

namespace palpate::reference {

// Bricks that come to hold one value become constant.
void applyEdits(Volume& volume, const LoweredEdits& edits);

}  // namespace palpate::reference
