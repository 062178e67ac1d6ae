// SPDX-License-Identifier: Apache-2.0
// engine/field/isosurface_mesh.hpp: the isosurface as triangles, for contact with a mesh and for files.
//
// Method: marching cubes (Lorensen and Cline, SIGGRAPH 1987) on the trilinear field between voxels. That field is
// smooth within a cell and has creases at the cells' faces, so the mesh has edges there. The surface passes through a
// cell of eight voxels in loops (cell_loops.hpp). A loop's vertices lie on the cell's edges and, where a line bends by
// much, on its faces (shared_vertices.hpp). It is filled with triangles of these alone where they are close to the
// surface, else around a vertex within the cell (loop_facets.hpp). Where the object reaches the volume's border, flat
// faces at the outermost voxel centres close it (border_facets.hpp), as everywhere in Palpate.
//
// The mesh is a closed surface by construction, for any densities:
// - A voxel at the isovalue is background. A vertex keeps 1/256 voxel from the ends of its edge, the edges of its face,
//   or the faces of its cell. This moves it from the trilinear surface by 1/256 voxel along each axis at most; all
//   other vertices lie on it.
// - On an ambiguous face, the inside corners are joined as the trilinear field joins them (Nielson and Hamann, IEEE
//   Visualization 1991). So the cells on both sides agree, and each line of a face belongs to one loop of either.
// - A tunnel within one cell, through the object or between two parts of it, is left out: each loop closes by itself.
// - Triangles within a cell have no edge on its faces but the lines there. So two cells never make the same edge, each
//   edge belongs to two triangles, and there is one ring of triangles around each vertex.
//
// Normals point out of the object. A few facets in cells that noise bends several ways turn by more than a right angle
// from the field's slope at their middle (docs/convert.md counts them).
//
// Frame: world [m]. Any thread, while nobody changes the volume. Cost: a look at each brick, and for each cell that the
// surface crosses some 3 us and kMeshBytesPerCell.
#pragma once

#include <cstddef>

#include "base/triangle_mesh.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// Of memory, at most: the cell, its place in a table, its shared vertices, and its part of the mesh.
inline constexpr double kMeshBytesPerCell = 350;

// The mesh has no triangles if the isovalue is outside the volume's values, or if the volume is one voxel thick and so
// encloses nothing. `adaptivity`, in [0, 1]: 0 follows the surface as above. Above 0, there are no vertices on faces,
// and within a cell only where a loop cannot be filled without; then vertices are left out where the surface is nearly
// flat (join_triangles.hpp); 1 leaves out most. The mesh stays closed; the remaining vertices do not move. Throws
// Error(kOutOfMemory), as soon as the cells are known, if the mesh would not fit into `memory_bytes` (0:
// availableMemoryBytes()), or has more vertices than 32 bits can number.
[[nodiscard]] TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity = 0,
                                          std::size_t memory_bytes = 0);

}  // namespace palpate
