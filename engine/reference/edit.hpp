// SPDX-License-Identifier: Apache-2.0
// engine/reference/edit.hpp: the CPU twin of the edit kernels, written from docs/edits.md (edited_density.hpp). It
// visits every voxel for every command, in order: slow and obvious. Kernels must agree bit for bit. Any thread.
#pragma once

#include "engine/edit/lower_edit.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

void applyEdits(DenseField& field, const LoweredEdits& edits);

}  // namespace palpate::reference
