// SPDX-License-Identifier: Apache-2.0
#include "engine/field/isosurface_mesh.hpp"

#include <algorithm>

#include "engine/field/join_triangles.hpp"
#include "engine/field/refine_triangles.hpp"
#include "engine/field/surface_cells.hpp"
#include "engine/field/surface_vertices.hpp"

namespace palpate {
namespace {

// Vertices are in index space until take().
class Mesher {
 public:
  Mesher(const Volume& volume, float isovalue)
      : lattice_(volume.lattice()),
        size_(volume.size()),
        isovalue_(isovalue),
        turned_(lattice_.R_WL.determinant() < 0),
        cells_(volume, isovalue) {
    mesh_.vertices_W.reserve(cells_.vertexCount());
    mesh_.triangles.reserve(2 * std::size_t{cells_.vertexCount()});
    for (const SurfaceCell& cell : cells_.all()) addVertices(cell);
    for (const SurfaceCell& cell : cells_.all()) {
      for (int axis = 0; axis < 3; ++axis) addQuad(cell, axis);
    }
  }

  void refine() { refineTriangles(mesh_, cells_, size_, isovalue_); }

  [[nodiscard]] TriangleMesh take() {
    for (Vec3& vertex : mesh_.vertices_W) vertex = lattice_.toWorld(vertex);
    if (turned_) {
      for (auto& t : mesh_.triangles) std::swap(t[1], t[2]);
    }
    return std::move(mesh_);
  }

 private:
  void addVertices(const SurfaceCell& cell) {
    const std::array<Vec3, 4> places_I = surfaceVertices(cell, size_, isovalue_);
    mesh_.vertices_W.insert(mesh_.vertices_W.end(), places_I.begin(), places_I.begin() + cell.loops.count);
  }

  // Adds the quad around the edge that runs along `axis` from the cell's first corner, if the surface crosses the edge.
  void addQuad(const SurfaceCell& cell, int axis) {
    if (cell.loops.of_edge[static_cast<std::size_t>(edgeFrom(0, axis))] == kNoLoop) return;
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    // Counter-clockwise, seen against the axis, starting with the cell that is lower along both u and v.
    std::array<std::uint32_t, 4> quad{};
    for (std::size_t n = 0; n < 4; ++n) {
      const int below_u = n == 0 || n == 3 ? 1 : 0;
      const int below_v = n < 2 ? 1 : 0;
      const SurfaceCell& around = cells_.at(cell.at - below_u * Vec3i::Unit(u) - below_v * Vec3i::Unit(v));
      const int edge = edgeFrom(below_u << u | below_v << v, axis);
      quad[n] = around.first_vertex + around.loops.of_edge[static_cast<std::size_t>(edge)];
    }
    const bool leaves = (cell.inside & 1) != 0;  // the edge leads out of the object
    if (!leaves) std::swap(quad[1], quad[3]);
    // Takes the diagonal whose smaller triangle is the larger one.
    const double first = std::min(area(quad[0], quad[1], quad[2]), area(quad[0], quad[2], quad[3]));
    const double second = std::min(area(quad[0], quad[1], quad[3]), area(quad[1], quad[2], quad[3]));
    const std::size_t start = first >= second ? 0 : 1;
    mesh_.triangles.push_back({quad[start], quad[start + 1], quad[start + 2]});
    mesh_.triangles.push_back({quad[start], quad[start + 2], quad[(start + 3) % 4]});
  }

  [[nodiscard]] double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const auto side_m = [&](std::uint32_t to) -> Vec3 {
      return (mesh_.vertices_W[to] - mesh_.vertices_W[a]).cwiseProduct(lattice_.spacing_m);
    };
    return side_m(b).cross(side_m(c)).norm();
  }

  const Lattice& lattice_;
  Vec3i size_;
  float isovalue_;
  bool turned_;
  SurfaceCells cells_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity) {
  const auto level = static_cast<float>(isovalue);
  if (!(volume.maximum() > level) || volume.size().minCoeff() < 2) return {};
  Mesher mesher(volume, level);
  if (!(adaptivity > 0)) mesher.refine();
  TriangleMesh mesh = mesher.take();
  if (adaptivity > 0) joinFlatTriangles(mesh, adaptivity, 8 * volume.lattice().spacing_m.maxCoeff());
  return mesh;
}

}  // namespace palpate
