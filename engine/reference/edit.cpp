// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/edit.hpp"

#include "engine/edit/edit_math.hpp"
#include "engine/reference/neighbours.hpp"

namespace palpate::reference {
namespace {

void applyOne(DenseField& field, const layout::EditCommand& command, std::span<const float> stamps) {
  const EditScale scale = editScale(field.lattice.spacing_m);
  const DenseField old = field;
  const auto density = [&](const Vec3i& at) { return old.at(at.x(), at.y(), at.z()); };
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        const edit_math::Local p = edit_math::local(command, scale, i, j, k);
        const float f = old.at(i, j, k);
        field.values[field.offset(i, j, k)] =
            edit_math::readsNeighbours(command)
                ? edit_math::editedWithNeighbours(command, scale, p, f, neighboursOf({i, j, k}, old.size, density))
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
