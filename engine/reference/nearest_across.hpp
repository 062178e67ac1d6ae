// SPDX-License-Identifier: Apache-2.0
// engine/reference/nearest_across.hpp: for each voxel of a field, the distance to the nearest voxel on the other side
// of an isovalue. It tries one voxel after another, the nearest first.
//
// This distance d bounds the distance to the isosurface from both sides. The surface crosses the line to that voxel, so
// it is not farther than d. And it is not nearer than d less a cell's diagonal. Any thread. Cost: near the surface, a
// look at every voxel nearer than the one found; far from it, little.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Which voxels are tried, and how distances are measured.
struct AcrossSearch {
  float isovalue = 0;                      // densities above it are inside
  Vec3 edge_square = Vec3::Ones();         // squares of a voxel's edge lengths, in any unit
  Vec3i reach = Vec3i::Constant(1);        // half size of the box that is searched, along each axis [voxel]
  std::function<void()> after_slice = {};  // called after each slice; may throw to stop the work
};

// For each voxel the square of the distance to the nearest voxel across the isovalue, in the unit of `edge_square`.
// Empty if the box of `reach` holds no such voxel. The squares along i and j are added first, then the one along k,
// each sum rounded to float, as in shaders/filter_distance_spread.comp. Rounding keeps the order, so the smallest sum
// is the same, bit for bit.
[[nodiscard]] std::vector<std::optional<float>> squaresAcross(const DenseField& field, const AcrossSearch& search);

}  // namespace palpate::reference
