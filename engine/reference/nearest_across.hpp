// SPDX-License-Identifier: Apache-2.0
// engine/reference/nearest_across.hpp: how far each voxel of a field lies from the nearest voxel on the other side of
// an isovalue, by trying one voxel after another, the nearest first. It bounds the distance from the surface on both
// sides: the surface crosses the way to that voxel, and no point of it is nearer than that voxel less a cell's
// diagonal. Any thread. Cost: for a voxel near the surface the voxels that are nearer than what is found; far from it
// little.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "engine/reference/dense_field.hpp"

namespace palpate::reference {

// Which voxels are tried, and what their way counts.
struct AcrossSearch {
  float isovalue = 0;                      // above it is inside
  Vec3 edge_square = Vec3::Ones();         // a voxel's edges, squared, in any unit
  Vec3i reach = Vec3i::Constant(1);        // how far along each axis [voxel]
  std::function<void()> after_slice = {};  // called so often that it may stop the work
};

// Of each voxel the square of the way to the nearest voxel across, in the unit of `edge_square`, or nothing if the box
// of `reach` holds none. Squares along i and j are added up first, then that along k, each rounded to float, as
// shaders/filter_distance_spread.comp does: the smallest sum is the same, bit for bit, since rounding keeps the order.
[[nodiscard]] std::vector<std::optional<float>> squaresAcross(const DenseField& field, const AcrossSearch& search);

}  // namespace palpate::reference
