// SPDX-License-Identifier: Apache-2.0
// servo/algorithms/cell_walk.hpp: where a straight line passes from cell to cell of a lattice.
//
// Along a line within one cell a trilinear field is a cubic. So a search that stops at every cell border can be exact
// in between. Frame L: the lattice [voxel]. Places are parameters t of the line, 0 to 1. Beyond the lattice there are
// no cells, only the places where the line enters and leaves it. Thread: any. Cost: a few comparisons a step. Errors:
// none.
#pragma once

#include "base/vec.hpp"

namespace palpate {

class CellWalk {
 public:
  // `last_L`: the lattice's last sample along each axis.
  CellWalk(const Vec3& from_L, const Vec3& to_L, const Vec3& last_L) noexcept;

  // The next place, greater than the last one; 1 at the end of the line.
  [[nodiscard]] double next() noexcept;

 private:
  [[nodiscard]] double crossing(int axis) const noexcept;

  Vec3 from_L_;
  Vec3 way_L_;
  Vec3 plane_L_ = Vec3::Zero();  // along each axis, the next border between cells
  double enters_ = 0;            // where the line enters and leaves the lattice
  double leaves_ = 1;
  double t_ = -1;
};

}  // namespace palpate
