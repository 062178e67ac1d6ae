// SPDX-License-Identifier: Apache-2.0
// engine/field/join_triangles.hpp: fewer triangles where a closed surface is nearly flat. Any thread. Cost: some 5 us
// a triangle, 150 bytes for each.
//
// A vertex is left out by drawing it onto a neighbour, which takes its triangles; all vertices that stay are where they
// were. It is done only where the surface stays one (the two have exactly the two neighbours in common that face their
// edge), where each new triangle has an area and faces as the surface did at its corners and at the vertex that is left
// out: the cosine is above 1 - adaptivity; and where no edge grows longer than `longest`.
#pragma once

#include "base/triangle_mesh.hpp"

namespace palpate {

// `mesh`: closed, two triangles at each edge, each with an area. `adaptivity`: in (0, 1]. `longest`: as its vertices.
void joinFlatTriangles(TriangleMesh& mesh, double adaptivity, double longest);

}  // namespace palpate
