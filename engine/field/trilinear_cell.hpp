// SPDX-License-Identifier: Apache-2.0
// engine/field/trilinear_cell.hpp: the trilinear field in one cell of eight voxels, above or below an isovalue. Private
// to engine/field.
//
// Frame: the cell's own, index space; its corners lie at 0 and 1 along each axis [voxel]. Any thread.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "engine/field/surface_cells.hpp"

namespace palpate {

// A mesh's vertices keep this from the ends of their edge, the edges of their face or the faces of their cell [voxel].
inline constexpr double kLeastShare = 1.0 / 256;

struct TrilinearCell {
  std::array<double, 8> excess{};  // density above the isovalue at each corner (cell_loops.hpp numbers them)

  [[nodiscard]] double at(const Vec3& p) const noexcept;
  [[nodiscard]] Vec3 gradient(const Vec3& p) const noexcept;  // [density/voxel]

  // Where the field's zero is met first on the way from `p` along `outward`, or against it where p is not inside. Looks
  // within the cell only. Empty: nowhere. The field along a line is a cubic polynomial, and the way is cut in eight:
  // what crosses zero twice within one part is not seen.
  [[nodiscard]] std::optional<Vec3> surfaceFrom(const Vec3& p, const Vec3& outward) const;
};

[[nodiscard]] TrilinearCell trilinearCell(const SurfaceCell& cell, float isovalue);

// The zero of a function between two points of different sign, to 1e-14 of the larger value. `excess(point)` is the
// function; `from` has the sign of `excess_from`, `to` has the other one.
template <typename Excess>
[[nodiscard]] Vec3 zeroBetween(Vec3 from, double excess_from, Vec3 to, double excess_to, const Excess& excess) {
  // The Illinois method: a secant, which halves the value at an end that has stayed twice.
  constexpr int kMostSteps = 60;
  const double near_enough = 1e-14 * std::max(std::abs(excess_from), std::abs(excess_to));
  int stayed = 0;
  Vec3 last = from;
  for (int step = 0; step < kMostSteps; ++step) {
    const Vec3 between = from + excess_from / (excess_from - excess_to) * (to - from);
    const double value = excess(between);
    last = between;
    if (std::abs(value) <= near_enough) break;
    if ((value > 0) == (excess_to > 0)) {
      to = between;
      excess_to = value;
      if (stayed == 1) excess_from /= 2;
      stayed = 1;
    } else {
      from = between;
      excess_from = value;
      if (stayed == -1) excess_to /= 2;
      stayed = -1;
    }
  }
  return last;
}

}  // namespace palpate
