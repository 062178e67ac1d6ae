// SPDX-License-Identifier: Apache-2.0
// engine/volume/isosurface_mesh.hpp: the isosurface as triangles, by OpenVDB's mesher, for contact with a mesh.
//
// The mesher puts one vertex into each voxel cell that the surface crosses, at the mean of the crossings of the cell's
// edges, and joins them by quads (dual contouring without normals); here each quad becomes two triangles, split along
// its shorter diagonal. Where the object reaches the volume's border it is closed by a face there, at the outermost
// voxel centres, as everywhere in Palpate; so the mesh is always closed, and its normals point out of the object.
// Frame: world [m]. Any thread, while nobody changes the volume. Cost: some 0.1 us a voxel near the surface, and a copy
// of the grid's stored bricks. An isovalue that the volume does not reach gives a mesh without triangles.
// `adaptivity` in [0, 1] lets the mesher join cells where the surface is nearly flat: 0 keeps every cell, 1 joins most;
// the mesh stays closed, its vertices leave the surface by less than the joined cells' size.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/volume/volume.hpp"

namespace palpate {

[[nodiscard]] TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity = 0);

}  // namespace palpate
