// SPDX-License-Identifier: Apache-2.0
// engine/field/shared_vertices.hpp: the vertices of an isosurface's mesh that several cells share. Private to
// engine/field.
//
// - On each crossed edge one, where the field, linear along the edge, is at the isovalue.
// - On a line of a face (cell_loops.hpp) one where it bends by much. The field on a face is bilinear, and the line a
//   part of a hyperbola. The vertex is where the hyperbola is parallel to the chord between the line's ends: there it
//   is farthest from it.
// - On each voxel inside the object on the volume's border: the corners of the flat faces that close the object there.
//
// A vertex on an edge keeps kLeastShare from both ends. So vertices are never at one place, and all triangles have an
// area, even where voxels are at the isovalue. This moves a vertex from the surface by kLeastShare at most.
//
// Frame: index space of the volume [voxel]. Any thread. Cost: some 0.5 us a cell.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/field/cell_loops.hpp"
#include "engine/field/surface_cells.hpp"

namespace palpate {

inline constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

class SharedVertices {
 public:
  // Appends the vertices. `size`: of the volume. `bend`: of lines with a vertex, the least product of the chord's
  // length and the greatest distance from it [voxel^2]. All references are kept.
  SharedVertices(const SurfaceCells& cells, const Vec3i& size, float isovalue, double bend,
                 std::vector<Vec3>& places_I);

  [[nodiscard]] bool holds(const Vec3i& voxel) const;  // whether the domain does
  [[nodiscard]] bool holdsFace(const SurfaceCell& cell, int face) const;

  [[nodiscard]] std::uint32_t onEdge(const SurfaceCell& cell, int edge) const;
  [[nodiscard]] std::uint32_t onLine(const SurfaceCell& cell, int face,
                                     int line) const;                               // kNoVertex: the line has none
  [[nodiscard]] std::uint32_t atCorner(const SurfaceCell& cell, int corner) const;  // inside, on the border

 private:
  // Of the edges from a cell's first corner, of the lines on its lower faces, and of one voxel on the border.
  struct Owned {
    std::array<std::uint32_t, 3> edges;
    std::array<std::array<std::uint32_t, 2>, 3> lines;
    std::uint32_t voxel;
  };
  [[nodiscard]] const Owned& ownedBy(const Vec3i& cell) const { return owned_[cells_.indexOf(cell)]; }
  [[nodiscard]] Vec3 crossing(const SurfaceCell& cell, int edge) const;
  void addLines(const SurfaceCell& cell, int axis, double bend, Owned& owned);
  std::uint32_t add(const Vec3& place_I);

  const SurfaceCells& cells_;
  const Vec3i& size_;
  float isovalue_;
  std::vector<Vec3>& places_I_;
  std::vector<Owned> owned_;
};

}  // namespace palpate
