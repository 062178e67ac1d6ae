// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/edit.hpp"

#include "engine/edit/edit_math.hpp"

namespace palpate::reference {
namespace {

edit_math::Neighbours neighboursOf(const DenseField& field, int i, int j, int k) {
  edit_math::Neighbours neighbours{};
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i before(i, j, k);
    Vec3i after(i, j, k);
    if (before[axis] > 0) --before[axis];
    if (after[axis] < field.size[axis] - 1) ++after[axis];
    neighbours.before[axis] = field.at(before.x(), before.y(), before.z());
    neighbours.after[axis] = field.at(after.x(), after.y(), after.z());
  }
  return neighbours;
}

void applyOne(DenseField& field, const layout::EditCommand& command, std::span<const float> stamps) {
  const EditScale scale = editScale(field.lattice.spacing_m);
  const DenseField old = field;
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        const edit_math::Local p = edit_math::local(command, scale, i, j, k);
        const float f = old.at(i, j, k);
        field.values[field.offset(i, j, k)] =
            edit_math::readsNeighbours(command)
                ? edit_math::editedWithNeighbours(command, scale, p, f, neighboursOf(old, i, j, k))
                : edit_math::edited(command, stamps, p, f);
      }
    }
  }
}

}  // namespace

void applyEdits(DenseField& field, const LoweredEdits& edits) {
  for (const layout::EditCommand& command : edits.commands) applyOne(field, command, edits.stamps);
}

}  // namespace palpate::reference
