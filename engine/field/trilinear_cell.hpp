// SPDX-License-Identifier: Apache-2.0
// engine/field/trilinear_cell.hpp: the trilinear field in one cell of eight voxels, above or below an isovalue. Private
// to engine/field.
//
// Frame: the cell's own, index space; its corners lie at 0 and 1 along each axis [voxel]. Any thread.
#pragma once

#include <array>
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

}  // namespace palpate
