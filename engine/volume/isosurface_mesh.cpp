// SPDX-License-Identifier: Apache-2.0
#include "engine/volume/isosurface_mesh.hpp"

#include <algorithm>
#include <limits>

#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "engine/volume/grid.hpp"

namespace palpate {
namespace {

// The volume with background all around it, so far below the isovalue that every crossing between a border voxel and it
// is at the voxel (to 1e-6 of a voxel).
ScalarGrid::Ptr padded(const Volume& volume, float isovalue) {
  ScalarGrid::Ptr field = volume.grid().field->deepCopy();
  const float above = std::max(volume.maximum() - isovalue, 1e-30F);
  // Not beyond the largest float, which densities may come near: then crossings lie elsewhere between a border voxel
  // and the background, outside of the volume, and are put onto its border like all others.
  const float below = std::max(isovalue - 1e6F * above, std::numeric_limits<float>::lowest());
  openvdb::tools::changeBackground(field->tree(), below);
  const Vec3i last = volume.size() - Vec3i::Ones();
  field->clip(openvdb::CoordBBox(openvdb::Coord(0, 0, 0), openvdb::Coord(last.x(), last.y(), last.z())));
  return field;
}

// Triangles whose corners go around the outward normal counter-clockwise. The mesher's go the other way around for
// density above the isovalue, seen in index space; a left-handed lattice mirrors them once more.
class Triangles {
 public:
  Triangles(TriangleMesh& mesh, bool turned) : mesh_(mesh), turned_(turned) {}

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.triangles.push_back(turned_ ? std::array{a, c, b} : std::array{a, b, c});
  }
  void add(const openvdb::Vec4I& q) {
    const bool first_is_shorter = length(q[0], q[2]) <= length(q[1], q[3]);
    add(q[0], q[1], first_is_shorter ? q[2] : q[3]);
    add(first_is_shorter ? q[0] : q[1], q[2], q[3]);
  }

 private:
  [[nodiscard]] double length(std::uint32_t a, std::uint32_t b) const {
    return (mesh_.vertices_W[a] - mesh_.vertices_W[b]).squaredNorm();
  }
  TriangleMesh& mesh_;
  bool turned_;
};

}  // namespace

TriangleMesh isosurfaceMesh(const Volume& volume, double isovalue, double adaptivity) {
  TriangleMesh mesh;
  const auto level = static_cast<float>(isovalue);
  if (!(volume.maximum() > level)) return mesh;
  std::vector<openvdb::Vec3s> points_I;  // the grid's transform is the identity: index space
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*padded(volume, level), points_I, triangles, quads, isovalue, adaptivity);
  const Vec3 last_I = volume.size().cast<double>().array() - 1;
  mesh.vertices_W.reserve(points_I.size());
  for (const openvdb::Vec3s& p : points_I) {
    const Vec3 p_I = Vec3(p.x(), p.y(), p.z()).cwiseMax(0.0).cwiseMin(last_I);
    mesh.vertices_W.push_back(volume.lattice().toWorld(p_I));
  }
  mesh.triangles.reserve(triangles.size() + 2 * quads.size());
  Triangles made(mesh, volume.lattice().R_WL.determinant() > 0);
  for (const openvdb::Vec3I& t : triangles) made.add(t[0], t[1], t[2]);
  for (const openvdb::Vec4I& q : quads) made.add(q);
  return mesh;
}

}  // namespace palpate
