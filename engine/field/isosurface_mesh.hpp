// SPDX-License-Identifier: Apache-2.0
// engine/field/isosurface_mesh.hpp: the isosurface as triangles, for contact with a mesh and for files.
//
// Method: dual marching cubes (Nielson, IEEE Visualization 2004). The surface passes through a cell of eight voxels in
// loops (cell_loops.hpp). Each loop gives one vertex: the mean of the points where it crosses the cell's edges. The
// four vertices around a crossed edge form a quad, here two triangles. Where the object reaches the volume's border, a
// face at the outermost voxel centres closes it, as everywhere in Palpate.
//
// The mesh is a closed surface by construction, for any densities:
// - A voxel at the isovalue is background. A crossing keeps a distance of 1/256 of its edge from either end. So every
//   vertex lies inside its cell. This moves the surface from the trilinear one by 1/256 voxel at most.
// - On an ambiguous face, the inside corners are joined as the trilinear field joins them. So the cells on both sides
//   agree, and each edge of the mesh belongs to two triangles. There is one exception: in each of the two cells a
//   single loop passes the face twice. There the corners are joined the other way, which splits both loops.
// - The four vertices of a quad lie in the four cells around an edge, so they are not on one line. Each diagonal cuts
//   the quad into two triangles. The diagonal is taken whose smaller triangle is the larger one; then both triangles
//   have an area.
//
// Normals point out of the object. Frame: world [m]. Any thread, while nobody changes the volume. Cost: some 1 us and
// 100 bytes for each cell that the surface crosses, and a look at each brick.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// The mesh has no triangles if the isovalue is outside the volume's values, or if the volume is one voxel thick and so
// encloses nothing. `adaptivity`, in [0, 1]: how many vertices are left out where the surface is nearly flat
// (join_triangles.hpp). 0 keeps all, 1 leaves out most. The mesh stays closed; the remaining vertices do not move.
[[nodiscard]] TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity = 0);

}  // namespace palpate
