// SPDX-License-Identifier: Apache-2.0
// engine/field/border_facets.hpp: the flat faces that close an isosurface's mesh where the object reaches the volume's
// border. Private to engine/field.
//
// Each square between four voxels of the border is filled where the object is: with triangles between its voxels inside
// and the lines of the isosurface on it (cell_loops.hpp), which keep away from its corners.
//
// Frame: index space of the volume [voxel]. Any thread.
#pragma once

#include "base/triangle_mesh.hpp"
#include "engine/field/shared_vertices.hpp"

namespace palpate {

// `cell`: beyond the border, so that at most one of its faces is in the domain. Its triangles are appended.
void addBorderFacets(const SurfaceCell& cell, const SharedVertices& vertices, TriangleMesh& mesh);

}  // namespace palpate
