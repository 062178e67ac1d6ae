// SPDX-License-Identifier: Apache-2.0
// engine/field/surface_vertices.hpp: where the vertices of an isosurface's cells lie, one for each loop
// (cell_loops.hpp). Private to engine/field.
//
// Frame: index space of the volume [voxel]. Any thread. Cost: some 0.3 us a vertex.
//
// - In a cell of the domain, the way begins at the mean of the points where the loop crosses the cell's edges. It goes
//   along the loop's normal to the surface of the trilinear field. Where it meets none in the cell (the surface of a
//   tunnel, say), it goes towards the corner of a crossed edge of the loop that leads there soonest: of an edge's two
//   ends, one is on the other side.
// - A cell beyond the domain lies on the volume's border. The object ends there in a flat face. Where the face's rim
//   passes, the vertex is on the rim, where the surface meets the border. In the face it is the middle of the voxels
//   inside. Two rims of a face in one cell share a vertex, between them.
// - Every vertex keeps kLeastShare from the faces of its cell, or of its cell's face on the border. So vertices of
//   neighbouring cells are never at one place. This moves a vertex from the trilinear surface by kLeastShare along each
//   axis at most, and only where the surface passes as close as that to a face of the cell.
#pragma once

#include <array>

#include "engine/field/surface_cells.hpp"

namespace palpate {

inline constexpr double kLeastShare = 1.0 / 256;  // least distance from the cell's faces [voxel]

// For each of the cell's loops. `size`: of the volume [voxel].
[[nodiscard]] std::array<Vec3, 4> surfaceVertices(const SurfaceCell& cell, const Vec3i& size, float isovalue);

}  // namespace palpate
