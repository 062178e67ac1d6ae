// SPDX-License-Identifier: Apache-2.0
// engine/field/loop_facets.hpp: the triangles of one loop of an isosurface in a cell. Private to engine/field.
//
// The loop's ring has its vertices on the cell's edges and faces (shared_vertices.hpp). There are two ways to fill it.
//
// Where it has no vertices on lines and the surface is close, all triangles begin at one of its vertices. Of such
// triangles an edge across the loop may not lie on a face of the cell: two cells then never make the same edge.
//
// Otherwise a vertex within the cell is its centre. The way to it begins at the ring's mean and goes along the ring's
// normal to the surface. Where it meets none in the cell (that of a tunnel, say), it goes towards a corner of a crossed
// edge. A triangle leads from the centre to each side of the ring. An edge from the centre to the ring whose middle is
// far from the surface gets a vertex. This moves from the middle onto the surface along the mean normal of the edge's
// two triangles. It is left out if a triangle would then face against the field's slope, seen in the world.
//
// So triangles end at the cells' faces, as the smooth pieces of the trilinear surface do.
//
// Frame: index space of the volume [voxel]. Any thread. Cost: some 1 us a loop.
#pragma once

#include <cstdint>
#include <vector>

#include "base/triangle_mesh.hpp"
#include "engine/field/trilinear_cell.hpp"

namespace palpate {

// How closely triangles follow the surface: what splits them only if more volume than that is between [voxel^3].
struct FacetGains {
  double centre = 0;  // between a loop's triangles of its own vertices and the surface
  double middle = 0;  // of the tetrahedra that a vertex on an edge from the centre adds or takes away
};

struct RingVertex {
  std::uint32_t vertex = 0;
  int edge = 0;  // that the loop crosses there; kOnLine: none, the vertex is on a line of a face
};
inline constexpr int kOnLine = -1;

// A cell that the surface crosses.
struct FacetCell {
  const TrilinearCell& field;
  std::uint8_t inside = 0;           // a bit for each corner above the isovalue
  Vec3 origin_I = Vec3::Zero();      // its first corner
  Vec3 per_spacing2 = Vec3::Ones();  // 1 / spacing^2 of each axis, up to a common factor
};

// Appends the loop's triangles and the vertices that only they have. `ring`: counter-clockwise, seen from outside of
// the object.
void addLoopFacets(const FacetCell& cell, const std::vector<RingVertex>& ring, const FacetGains& gains,
                   TriangleMesh& mesh_I);

}  // namespace palpate
