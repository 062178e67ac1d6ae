// SPDX-License-Identifier: Apache-2.0
// engine/reference/edit.hpp: the CPU twin of the edit kernels: commands one after another over the whole volume. Any
// thread. It visits every voxel for every command, so it is slow and obvious; kernels must agree bit for bit.
#pragma once

#include "engine/edit/lower_edit.hpp"
#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

void applyEdits(DenseField& field, const LoweredEdits& edits);

}  // namespace palpate::reference
