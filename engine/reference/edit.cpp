// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/edit.hpp"

#include "engine/reference/edited_density.hpp"
#include "engine/reference/neighbours.hpp"

namespace palpate::reference {
namespace {

void applyOne(DenseField& field, const layout::EditCommand& command, std::span<const float> stamps) {
  const layout::EditScale scale = editScale(field.lattice.spacing_m);
  const DenseField old = field;
  const auto density = [&](const Vec3i& at) { return old.at(at.x(), at.y(), at.z()); };
  for (int k = 0; k < field.size.z(); ++k) {
    for (int j = 0; j < field.size.y(); ++j) {
      for (int i = 0; i < field.size.x(); ++i) {
        const Vec3i voxel(i, j, k);
        const Neighbours around = readsNeighbours(command) ? neighboursOf(voxel, old.size, density) : Neighbours{};
        field.values[field.offset(i, j, k)] = editedDensity(command, scale, stamps, voxel, density(voxel), around);
      }
    }
  }
}

}  // namespace

void applyEdits(DenseField& field, const LoweredEdits& edits) {
  for (const layout::EditCommand& command : edits.commands) applyOne(field, command, edits.stamps);
}

}  // namespace palpate::reference
