// SPDX-License-Identifier: Apache-2.0
// engine/reference/edit_bricks.hpp: a faster CPU twin of the edit kernels, for replaying long lists of edits: it visits
// only the bricks that a command can reach. The result is bit for bit that of reference/edit.hpp and of the kernels.
// Any thread, while nobody else uses the volume. Cost: some 10 us for each brick and command.
#pragma once

#include "engine/edit/lower_edit.hpp"
#include "engine/field/volume.hpp"

namespace palpate::reference {

// A brick that ends with one value everywhere becomes constant.
void applyEdits(Volume& volume, const LoweredEdits& edits);

}  // namespace palpate::reference
