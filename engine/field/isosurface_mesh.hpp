// SPDX-License-Identifier: Apache-2.0
// engine/field/isosurface_mesh.hpp: the isosurface as triangles, for contact with a mesh and for files.
//
// One vertex lies in each cell of eight voxels for each loop in which the surface goes through it (cell_loops.hpp), at
// the mean of the loop's crossings of the cell's edges; around each edge that is crossed, four of them make a quad
// (dual marching cubes: Nielson, IEEE Visualization 2004), here two triangles. Where the object reaches the volume's
// border it is closed by a face there, at the outermost voxel centres, as everywhere in Palpate.
//
// The mesh is a closed surface by construction, for any densities:
// - A voxel at the isovalue is background, and a crossing keeps 1/256 of its edge away from either end. So every vertex
//   lies inside its cell, and the surface leaves the trilinear one by 1/256 voxel at most for that.
// - On a face with two inside corners that face each other these are joined as the trilinear field joins them, so the
//   cells on both sides agree. Each edge of the mesh then belongs to two triangles, but where one loop on either side
//   passes the face twice: there the corners are joined the other way, which parts each of the two loops.
// - The four vertices of a quad lie in four cells around an edge, so no line holds them all, and of the two diagonals
// the
//   one with the larger smaller triangle gives two triangles with an area.
//
// Normals point out of the object. Frame: world [m]. Any thread, while nobody changes the volume. Cost: some 1 us a
// cell that the surface crosses, 100 bytes for each, and a look at each brick. An isovalue that the volume does not
// reach gives a mesh without triangles, and so does a volume one voxel thick, which encloses nothing. `adaptivity` in
// [0, 1]: vertices where the surface is nearly flat are left out (join_triangles.hpp), 0 keeps all, 1 leaves out most;
// the mesh stays a closed surface, and its vertices are some of those that it would have had.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/field/volume.hpp"

namespace palpate {

[[nodiscard]] TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity = 0);

}  // namespace palpate
