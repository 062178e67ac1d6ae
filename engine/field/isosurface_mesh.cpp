// SPDX-License-Identifier: Apache-2.0
#include "engine/field/isosurface_mesh.hpp"

#include <algorithm>

#include "engine/field/join_triangles.hpp"
#include "engine/field/surface_cells.hpp"

namespace palpate {
namespace {

constexpr double kLeastShare = 1.0 / 256;  // least distance of a crossing from the edge's ends, as a share of the edge

Vec3i cornerOf(int corner) {
  return {corner & 1, corner >> 1 & 1, corner >> 2};
}

// Where the surface crosses an edge of a cell, relative to the cell's first corner, in index space.
Vec3 crossingOf(const SurfaceCell& cell, int edge, double isovalue) {
  const EdgeEnds ends = edgeEnds(edge);
  const double first = cell.densities[static_cast<std::size_t>(ends.first)];
  const double last = cell.densities[static_cast<std::size_t>(ends.last)];
  const double share = std::clamp((first - isovalue) / (first - last), kLeastShare, 1 - kLeastShare);
  return cornerOf(ends.first).cast<double>() + share * (cornerOf(ends.last) - cornerOf(ends.first)).cast<double>();
}

class Mesher {
 public:
  Mesher(const Volume& volume, float isovalue)
      : lattice_(volume.lattice()),
        last_I_(volume.size().cast<double>().array() - 1),
        turned_(lattice_.R_WL.determinant() < 0),
        cells_(volume, isovalue) {
    mesh_.vertices_W.reserve(cells_.vertexCount());
    mesh_.triangles.reserve(2 * std::size_t{cells_.vertexCount()});
    for (const SurfaceCell& cell : cells_.all()) addVertices(cell, isovalue);
    for (const SurfaceCell& cell : cells_.all()) {
      for (int axis = 0; axis < 3; ++axis) addQuad(cell, axis);
    }
  }

  [[nodiscard]] TriangleMesh take() { return std::move(mesh_); }

 private:
  // Adds a vertex for each loop. On an edge that leaves the domain, the surface shall pass through the voxel inside.
  // The clamp moves the vertex there.
  void addVertices(const SurfaceCell& cell, double isovalue) {
    std::array<Vec3, 4> sums;
    std::array<int, 4> counts{};
    sums.fill(Vec3::Zero());
    for (int edge = 0; edge < kCellEdges; ++edge) {
      const std::size_t loop = cell.loops.of_edge[static_cast<std::size_t>(edge)];
      if (loop == kNoLoop) continue;
      sums[loop] += crossingOf(cell, edge, isovalue);
      ++counts[loop];
    }
    for (std::size_t loop = 0; loop < static_cast<std::size_t>(cell.loops.count); ++loop) {
      const Vec3 p_I = cell.at.cast<double>() + sums[loop] / counts[loop];
      mesh_.vertices_W.push_back(lattice_.toWorld(p_I.cwiseMax(0.0).cwiseMin(last_I_)));
    }
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
    if (leaves == turned_) std::swap(quad[1], quad[3]);
    // Takes the diagonal whose smaller triangle is the larger one.
    const double first = std::min(area(quad[0], quad[1], quad[2]), area(quad[0], quad[2], quad[3]));
    const double second = std::min(area(quad[0], quad[1], quad[3]), area(quad[1], quad[2], quad[3]));
    const std::size_t start = first >= second ? 0 : 1;
    mesh_.triangles.push_back({quad[start], quad[start + 1], quad[start + 2]});
    mesh_.triangles.push_back({quad[start], quad[start + 2], quad[(start + 3) % 4]});
  }

  [[nodiscard]] double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3& corner_W = mesh_.vertices_W[a];
    return (mesh_.vertices_W[b] - corner_W).cross(mesh_.vertices_W[c] - corner_W).norm();
  }

  const Lattice& lattice_;
  Vec3 last_I_;
  bool turned_;
  SurfaceCells cells_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity) {
  const auto level = static_cast<float>(isovalue);
  if (!(volume.maximum() > level) || volume.size().minCoeff() < 2) return {};
  TriangleMesh mesh = Mesher(volume, level).take();
  if (adaptivity > 0) joinFlatTriangles(mesh, adaptivity, 8 * volume.lattice().spacing_m.maxCoeff());
  return mesh;
}

}  // namespace palpate
