// SPDX-License-Identifier: Apache-2.0
// engine/field/isosurface_mesh.hpp: the isosurface as triangles, for contact with a mesh and for files.
//
// Method: dual marching cubes (Nielson, IEEE Visualization 2004). The surface passes through a cell of eight voxels in
// loops (cell_loops.hpp). Each loop gives one vertex, on the surface of the trilinear field (surface_vertices.hpp). The
// four vertices around a crossed edge form a quad, here two triangles. Where the object reaches the volume's border, a
// face at the outermost voxel centres closes it, as everywhere in Palpate. Where facets leave the trilinear surface by
// much, triangles are split and their new vertices moved onto it (refine_triangles.hpp): facets on a convex surface lie
// inside it, and 1.3 % of a chest scan's volume would be missing.
//
// The mesh is a closed surface by construction, for any densities:
// - A voxel at the isovalue is background. A vertex keeps 1/256 voxel from the faces of its cell. This moves it from
// the
//   trilinear surface by 1/256 voxel along each axis at most.
// - On an ambiguous face, the inside corners are joined as the trilinear field joins them. So the cells on both sides
//   agree, and each edge of the mesh belongs to two triangles. There is one exception: in each of the two cells a
//   single loop passes the face twice. There the corners are joined the other way, which splits both loops.
// - A tunnel within one cell, through the object or between two parts of it, is left out: each loop closes by itself.
// - The four vertices of a quad lie in the four cells around an edge, so they are not on one line. Each diagonal cuts
//   the quad into two triangles. The diagonal is taken whose smaller triangle is the larger one; then both triangles
//   have an area.
//
// Normals point out of the object. Some facets in cells that noise bends several ways (3 % of them, in a chest scan)
// turn by more than a right angle from the field's gradient at their middle.
//
// Frame: world [m]. Any thread, while nobody changes the volume. Cost: some 1.5 us and 150 bytes for each cell that the
// surface crosses, a look at each brick, and for each split 3 us and 200 bytes: none on a plane, 4 a cell in noise.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

// The mesh has no triangles if the isovalue is outside the volume's values, or if the volume is one voxel thick and so
// encloses nothing. `adaptivity`, in [0, 1]: 0 splits triangles as above. Above 0, none is split, and vertices are left
// out where the surface is nearly flat (join_triangles.hpp); 1 leaves out most. The mesh stays closed; the remaining
// vertices do not move.
[[nodiscard]] TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity = 0);

}  // namespace palpate
