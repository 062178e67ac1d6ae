// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/edit.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "engine/edit/edit_reach.hpp"
#include "engine/field/brick_values.hpp"
#include "engine/reference/edited_density.hpp"

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

using Brick = std::array<float, kBrickVoxels>;

std::size_t offsetIn(const Vec3i& at) {
  const Vec3i in = at.unaryExpr([](int i) { return i % kBrickSize; });
  return (static_cast<std::size_t>(in.z()) * kBrickSize + in.y()) * kBrickSize + in.x();
}

// The bricks before a command, each read once.
class Before {
 public:
  explicit Before(const Volume& volume, const BrickGrid& grid) : volume_(volume), grid_(grid) {}

  const Brick& brick(const Vec3i& at) {
    const auto [entry, is_new] = bricks_.try_emplace(grid_.index(at));
    if (is_new && volume_.readBrick(at, entry->second.data())) entry->second.fill(entry->second[0]);
    return entry->second;
  }
  float at(const Vec3i& voxel) { return brick(voxel / kBrickSize)[offsetIn(voxel)]; }

 private:
  const Volume& volume_;
  const BrickGrid& grid_;
  std::unordered_map<std::uint32_t, Brick> bricks_;  // references to its elements stay valid
};

// Voxels of a brick outside the domain repeat the nearest one inside.
Brick editedBrick(Before& before, const Vec3i& brick, const Vec3i& size, const layout::EditCommand& command,
                  const layout::EditScale& scale, std::span<const float> stamps) {
  const Brick& old = before.brick(brick);
  const Vec3i first = brick * kBrickSize;
  Brick values;
  for (int k = 0; k < kBrickSize; ++k) {
    for (int j = 0; j < kBrickSize; ++j) {
      for (int i = 0; i < kBrickSize; ++i) {
        const Vec3i voxel = (first + Vec3i(i, j, k)).cwiseMin(size - Vec3i::Ones());
        const Neighbours around = readsNeighbours(command)
                                      ? neighboursOf(voxel, size, [&](const Vec3i& at) { return before.at(at); })
                                      : Neighbours{};
        values[offsetIn(Vec3i(i, j, k))] = editedDensity(command, scale, stamps, voxel, old[offsetIn(voxel)], around);
      }
    }
  }
  return values;
}

void applyOne(Volume& volume, const BrickGrid& grid, const layout::EditCommand& command,
              std::span<const float> stamps) {
  const layout::EditScale scale = editScale(grid.spacing_m);
  Before before(volume, grid);
  std::vector<std::pair<Vec3i, Brick>> changed;  // written to the volume once no neighbour is read any more
  for (const std::uint32_t index : reachedBricks(command, grid)) {
    const Vec3i brick = grid.brick(index);
    const Brick values = editedBrick(before, brick, grid.size, command, scale, stamps);
    if (!sameBits(values, before.brick(brick))) changed.emplace_back(brick, values);
  }
  for (const auto& [brick, values] : changed) {
    putBrick(volume, brick, std::span(values).first(holdOneValue(values) ? 1 : kBrickVoxels));
  }
}

}  // namespace

void applyEdits(DenseField& field, const LoweredEdits& edits) {
  for (const layout::EditCommand& command : edits.commands) applyOne(field, command, edits.stamps);
}

void applyEdits(Volume& volume, const LoweredEdits& edits) {
  const BrickGrid grid{volume.size(), volume.lattice().spacing_m};
  for (const layout::EditCommand& command : edits.commands) applyOne(volume, grid, command, edits.stamps);
}

}  // namespace palpate::reference
