// SPDX-License-Identifier: Apache-2.0
// engine/reference/edit.hpp: the CPU twins of the edit kernels, written from docs/edits.md (edited_density.hpp). Both
// give the same densities, and kernels must agree with them bit for bit.
#pragma once

#include "engine/edit/lower_edit.hpp"
#include "engine/field/volume.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Visits every voxel for every command, in order: slow and obvious. Any thread.
void applyEdits(DenseField& field, const LoweredEdits& edits);

// For replaying long lists of edits: visits only the bricks that a command can reach. A brick that ends with one value
// everywhere becomes constant. Any thread, while nobody else uses the volume. Cost: some 10 us for each brick and
// command.
void applyEdits(Volume& volume, const LoweredEdits& edits);

}  // namespace palpate::reference
