// SPDX-License-Identifier: Apache-2.0
// engine/field/face_curve.hpp: where the isosurface of a trilinear field meets a face of its cell. The field on a face
// is bilinear, so that is a part of a hyperbola. Private to engine/field.
//
// Frame: the cell's own, index space; its corners lie at 0 and 1 along each axis [voxel]. Any thread.
#pragma once

#include <optional>

#include "engine/field/trilinear_cell.hpp"

namespace palpate {

// Of the hyperbola between two of its points on a face, the point farthest from their chord. Empty:
// - the chord's length times that distance is less than `bend` [voxel^2];
// - the point is closer than kLeastShare to the face's edges;
// - it does not lie between the two along both axes. This happens only where one of them was moved off the hyperbola.
[[nodiscard]] std::optional<Vec3> farthestOnFace(const TrilinearCell& field, int face, const Vec3& from, const Vec3& to,
                                                 double bend);

}  // namespace palpate
