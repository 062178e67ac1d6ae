// SPDX-License-Identifier: Apache-2.0
#include "engine/field/isosurface_mesh.hpp"

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/byte_size.hpp"
#include "base/error.hpp"
#include "engine/field/border_facets.hpp"
#include "engine/field/join_triangles.hpp"
#include "engine/field/loop_facets.hpp"
#include "engine/field/memory_budget.hpp"
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

void checkMeshMemory(const Volume& volume, float isovalue, std::size_t cells, std::size_t memory_bytes) {
  constexpr std::size_t kMostCells = std::numeric_limits<std::uint32_t>::max() / 8;  // of 6 vertices at most, or so
  const std::size_t budget = memory_bytes != 0 ? memory_bytes : availableMemoryBytes();
  const double needed = kMeshBytesPerCell * static_cast<double>(cells);
  if (cells <= kMostCells && needed <= static_cast<double>(budget)) return;
  throw Error(
      Error::Code::kOutOfMemory, volume.facts().source,
      fmt::format("its isosurface at {:g} passes through {} cells of eight voxels; a mesh of that needs {}, and "
                  "{} are free",
                  isovalue, cells, inMiB(static_cast<std::uint64_t>(needed)), inMiB(budget)),
      "smooth, crop or resample the volume, or choose another isovalue");
}

// Vertices are in index space until take().
class Mesher {
 public:
  Mesher(const Volume& volume, const SurfaceCells& cells, float isovalue, const Closeness& closeness)
      : lattice_(volume.lattice()),
        size_(volume.size()),
        isovalue_(isovalue),
        closeness_(closeness),
        per_spacing2_((lattice_.spacing_m / lattice_.spacing_m.minCoeff()).cwiseAbs2().cwiseInverse()),
        vertices_(cells, size_, isovalue, closeness.bend, mesh_.vertices_W) {
    for (const SurfaceCell& cell : cells.all()) {
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
      addLoopFacets({field, cell.inside, cell.at.cast<double>(), per_spacing2_}, ring_, closeness_.gains, mesh_);
    }
  }

  const Lattice& lattice_;
  Vec3i size_;
  float isovalue_;
  Closeness closeness_;
  Vec3 per_spacing2_;
  TriangleMesh mesh_;
  SharedVertices vertices_;
  std::vector<RingVertex> ring_;  // of the loop at hand
};

}  // namespace

TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity, std::size_t memory_bytes) {
  const auto level = static_cast<float>(isovalue);
  if (!(volume.maximum() > level) || volume.size().minCoeff() < 2) return {};
  const SurfaceCells cells(volume, level);
  checkMeshMemory(volume, level, cells.all().size(), memory_bytes);
  TriangleMesh mesh = Mesher(volume, cells, level, adaptivity > 0 ? kCoarse : kClose).take();
  if (adaptivity > 0) joinFlatTriangles(mesh, adaptivity, 8 * volume.lattice().spacing_m.maxCoeff());
  return mesh;
}

}  // namespace palpate
