// SPDX-License-Identifier: Apache-2.0
#include "engine/field/isosurface_mesh.hpp"

#include <limits>
#include <utility>
#include <vector>

#include "engine/field/border_facets.hpp"
#include "engine/field/join_triangles.hpp"
#include "engine/field/loop_facets.hpp"
#include "engine/field/shared_vertices.hpp"
#include "engine/field/surface_cells.hpp"

namespace palpate {
namespace {

struct Closeness {
  double bend;  // shared_vertices.hpp
  FacetGains gains;
};
constexpr double kNever = std::numeric_limits<double>::infinity();
// Whole scans keep their volume to 0.17 % (docs/convert.md). At 0.03 and 0.003 they keep it to 0.2 %, with a fifth
// fewer triangles.
constexpr Closeness kClose{0.02, {0.003, 0.002}};
constexpr Closeness kCoarse{kNever, {kNever, kNever}};

// Vertices are in index space until take().
class Mesher {
 public:
  Mesher(const Volume& volume, float isovalue, const Closeness& closeness)
      : lattice_(volume.lattice()),
        size_(volume.size()),
        isovalue_(isovalue),
        closeness_(closeness),
        cells_(volume, isovalue),
        vertices_(cells_, size_, isovalue, closeness.bend, mesh_.vertices_W) {
    for (const SurfaceCell& cell : cells_.all()) {
      const bool in_domain = vertices_.holds(cell.at) && vertices_.holds(cell.at + Vec3i::Ones());
      if (in_domain) {
        addLoops(cell);
      } else {
        addBorderFacets(cell, vertices_, mesh_);
      }
    }
  }

  [[nodiscard]] TriangleMesh take() {
    for (Vec3& vertex : mesh_.vertices_W) vertex = lattice_.toWorld(vertex);
    if (lattice_.R_WL.determinant() < 0) {
      for (auto& t : mesh_.triangles) std::swap(t[1], t[2]);
    }
    return std::move(mesh_);
  }

 private:
  void addLoops(const SurfaceCell& cell) {
    const CellLoops loops = loopsOf(cell.inside, cell.joined);
    const TrilinearCell field = trilinearCell(cell, isovalue_);
    for (std::size_t loop = 0; loop < static_cast<std::size_t>(loops.count); ++loop) {
      ring_.clear();
      for (int n = loops.first[loop]; n < loops.first[loop + 1]; ++n) {
        const LoopStep& step = loops.steps[static_cast<std::size_t>(n)];
        ring_.push_back({vertices_.onEdge(cell, step.edge), step.edge});
        const std::uint32_t bend = vertices_.onLine(cell, step.face, step.line);
        if (bend != kNoVertex) ring_.push_back({bend, kOnLine});
      }
      addLoopFacets(field, cell.inside, cell.at.cast<double>(), ring_, closeness_.gains, mesh_);
    }
  }

  const Lattice& lattice_;
  Vec3i size_;
  float isovalue_;
  Closeness closeness_;
  SurfaceCells cells_;
  TriangleMesh mesh_;
  SharedVertices vertices_;
  std::vector<RingVertex> ring_;  // of the loop at hand
};

}  // namespace

TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity) {
  const auto level = static_cast<float>(isovalue);
  if (!(volume.maximum() > level) || volume.size().minCoeff() < 2) return {};
  TriangleMesh mesh = Mesher(volume, level, adaptivity > 0 ? kCoarse : kClose).take();
  if (adaptivity > 0) joinFlatTriangles(mesh, adaptivity, 8 * volume.lattice().spacing_m.maxCoeff());
  return mesh;
}

}  // namespace palpate
