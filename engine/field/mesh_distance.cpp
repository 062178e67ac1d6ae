// SPDX-License-Identifier: Apache-2.0
#include "engine/field/mesh_distance.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/module.hpp"
#include "base/units.hpp"
#include "engine/field/field_grid.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseMesh(const std::string& reason, const std::string& remedy) {
  throw Error(Error::Code::kBadInput, "mesh", reason, remedy);
}

void checkMesh(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
               std::initializer_list<double> lengths_m) {
  if (!std::all_of(lengths_m.begin(), lengths_m.end(), [](double m) { return std::isfinite(m) && m > 0; }))
    refuseMesh("its voxel size, band or depth is not positive", "give lengths above 0");
  if (triangles.empty()) refuseMesh("it has no triangles", "give a closed surface");
  const int count = static_cast<int>(points.size());
  for (const Vec3i& triangle : triangles) {
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= count)
      refuseMesh(fmt::format("a triangle names a corner that is not among its {}", count), "write it again");
  }
  for (const Vec3& point : points) {
    if (!point.allFinite()) refuseMesh("one of its corners is not a number", "write it again");
  }
}

}  // namespace

MeshDistance meshDistance(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles, double voxel_m,
                          double band_m, double depth_m) {
  checkMesh(points, triangles, {voxel_m, band_m, depth_m});
  Vec3 low = points[static_cast<std::size_t>(triangles.front().x())];
  Vec3 high = low;
  for (const Vec3i& triangle : triangles) {
    for (const int corner : triangle) {
      low = low.cwiseMin(points[static_cast<std::size_t>(corner)]);
      high = high.cwiseMax(points[static_cast<std::size_t>(corner)]);
    }
  }
  const double band_voxels = std::ceil(band_m / voxel_m) + 1;
  const Vec3 voxels = ((high - low) / voxel_m).array().ceil() + 2 * band_voxels + 1;
  if (voxels.maxCoeff() > kMaxMeshVoxels) {
    refuseMesh(fmt::format("at {:g} mm it needs {:.0f} voxels along an axis, and {} are the most",
                           voxel_m * kMillimetresPerMetre, voxels.maxCoeff(), kMaxMeshVoxels),
               "give a larger voxel or a smaller mesh");
  }
  MeshDistance mesh;
  mesh.size = voxels.cast<int>();
  mesh.lattice.spacing_m = Vec3::Constant(voxel_m);
  mesh.lattice.origin_W = low - Vec3::Constant(band_voxels * voxel_m);

  std::vector<Vec3> points_L;  // in voxels of the lattice, since VDB refuses transforms with voxels of micrometres
  points_L.reserve(points.size());
  for (const Vec3& point : points) points_L.push_back(mesh.lattice.toIndex(point));
  // No point inside lies deeper than half the narrowest side of the mesh's box.
  const double deepest_m = std::min(depth_m, (high - low).minCoeff() / 2);
  const auto depth = static_cast<float>(std::ceil(deepest_m / voxel_m) + 1);
  mesh.distance_m =
      loadModule<FieldModule>().meshDistances(points_L, triangles, mesh.size, static_cast<float>(band_voxels), depth);
  for (float& distance : mesh.distance_m) distance *= static_cast<float>(voxel_m);
  return mesh;
}

}  // namespace palpate
