// SPDX-License-Identifier: Apache-2.0
// engine/field/join_triangles.hpp: fewer triangles where a closed surface is nearly flat. Any thread. Cost: some 2 us
// and 150 bytes for each triangle.
//
// An edge is collapsed: one of its two vertices is left out, and its triangles go to the other one. The vertices that
// remain do not move. An edge is collapsed only if
// - the surface stays a surface: the edge's vertices share exactly two neighbours, those opposite the edge;
// - each new triangle has an area;
// - each new triangle faces as the surface did before, at its corners and at the vertex that is left out: the cosine
//   between the normals is above 1 - adaptivity;
// - no edge becomes longer than `longest`.
#pragma once

#include "base/triangle_mesh.hpp"

namespace palpate {

// `mesh`: closed; two triangles at each edge, each with an area. `adaptivity`: in (0, 1]. `longest`: the greatest
// length of an edge, in the unit of the vertices.
void joinFlatTriangles(TriangleMesh& mesh, double adaptivity, double longest);

}  // namespace palpate
