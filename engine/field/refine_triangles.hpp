// SPDX-License-Identifier: Apache-2.0
// engine/field/refine_triangles.hpp: more triangles where a closed mesh of the isosurface leaves the surface of the
// trilinear field. Private to engine/field.
//
// The facets between vertices on a convex surface lie inside it, so a mesh is too small where the surface bends within
// a cell. Therefore an edge is split at its middle, which moves onto the surface, along the mean normal of the edge's
// two triangles. Each of the two becomes two. An edge is split if
// - that adds or takes away kLeastGain of volume, as tetrahedra on the edge's triangles;
// - the surface lies within half the edge's length of its middle;
// - the edge is longer than kShortest, and made by fewer than kMostSplits splits, one in the other;
// - each new triangle faces as the one that it was part of, and is no sliver;
// - the angle between its normal and that of the neighbour that stays is a right one at most, or no larger than it was.
//   Otherwise triangles would turn over their neighbours, and enclose a place twice.
// An edge on the volume's border stays on it. So the mesh stays closed, with a ring of triangles around each vertex.
//
// kLeastGain decides how many are split. At 0.0025 voxel^3 whole scans keep their volume to 0.1 %, noisy chests to 0.35
// %. What is missing there is in tunnels, and in cells that bend several ways.
//
// Frame: index space of the volume [voxel]. Any thread. Cost: some 0.3 us an edge, 3 us a split.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/field/surface_cells.hpp"

namespace palpate {

// `mesh_I`: closed; two triangles at each edge; vertices in index space. `size`: of the volume [voxel].
void refineTriangles(TriangleMesh& mesh_I, const SurfaceCells& cells, const Vec3i& size, float isovalue);

}  // namespace palpate
