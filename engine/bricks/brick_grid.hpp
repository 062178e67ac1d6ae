// SPDX-License-Identifier: Apache-2.0
// engine/bricks/brick_grid.hpp: the bricks of a volume's domain, numbered as in the page table, and boxes of voxels.
// Any thread.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/vec.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Inclusive box of voxels.
struct VoxelBox {
  Vec3i first = Vec3i::Zero();
  Vec3i last = Vec3i::Constant(-1);
  [[nodiscard]] bool empty() const noexcept { return (first.array() > last.array()).any(); }
};
[[nodiscard]] VoxelBox intersection(const VoxelBox& a, const VoxelBox& b);
[[nodiscard]] VoxelBox hull(const VoxelBox& a, const VoxelBox& b);

// A brick, and the box around those of its voxels that may have changed.
struct ChangedBrick {
  std::uint32_t brick = 0;
  VoxelBox voxels;
};

struct BrickGrid {
  Vec3i size = Vec3i::Zero();  // domain [voxel]
  Vec3 spacing_m = Vec3::Ones();

  [[nodiscard]] Vec3i counts() const noexcept;  // bricks along each axis
  [[nodiscard]] std::size_t brickCount() const noexcept;
  [[nodiscard]] std::uint32_t index(const Vec3i& brick) const noexcept;
  [[nodiscard]] Vec3i brick(std::uint32_t index) const noexcept;
  [[nodiscard]] bool holds(const Vec3i& brick) const noexcept;
  [[nodiscard]] VoxelBox box(std::uint32_t index) const noexcept;  // the brick's voxels in the domain
  [[nodiscard]] VoxelBox widened(const VoxelBox& box, const Vec3i& by) const noexcept;  // cut to the domain

  // Visits every brick, or those that hold a voxel of a box, in the order of their indices.
  template <typename Visit>
  void forEach(const Visit& visit) const {
    forEachIn({Vec3i::Zero(), size - Vec3i::Ones()}, visit);
  }
  template <typename Visit>
  void forEachIn(const VoxelBox& box, const Visit& visit) const {
    if (box.empty()) return;
    const Vec3i low = box.first / kBrickSize, high = box.last / kBrickSize;
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) visit(Vec3i(x, y, z));
      }
    }
  }
  // Visits the indices of the bricks within `ring` bricks of a brick along each axis, itself included, ascending.
  template <typename Visit>
  void forEachWithin(const Vec3i& brick, const Vec3i& ring, const Visit& visit) const {
    const Vec3i low = (brick - ring).cwiseMax(Vec3i::Zero());
    const Vec3i high = (brick + ring).cwiseMin(counts() - Vec3i::Ones());
    forEachIn({low * kBrickSize, high * kBrickSize}, [&](const Vec3i& other) { visit(index(other)); });
  }
  // Visits the indices of a brick and of all that touch it: 27, fewer at the domain's border.
  template <typename Visit>
  void forEachAround(const Vec3i& brick, const Visit& visit) const {
    forEachWithin(brick, Vec3i::Ones(), visit);
  }
  // Visits the indices of a brick and of the bricks that share its first (step -1) or last (step 1) corner: seven more,
  // fewer at the domain's border.
  template <typename Visit>
  void forEachAtCorner(const Vec3i& brick, int step, const Visit& visit) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3i other = brick + step * Vec3i(corner & 1, corner >> 1 & 1, corner >> 2);
      if (holds(other)) visit(index(other));
    }
  }
  // Visits the indices of the bricks that share a face with a brick: six, fewer at the domain's border.
  template <typename Visit>
  void forEachBeside(const Vec3i& brick, const Visit& visit) const {
    for (int side = 0; side < 6; ++side) {
      const Vec3i other = brick + Vec3i::Unit(side / 2) * (side % 2 == 0 ? -1 : 1);
      if (holds(other)) visit(index(other));
    }
  }
};

}  // namespace palpate
