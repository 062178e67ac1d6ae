// SPDX-License-Identifier: Apache-2.0
// Distances to a mesh, by OpenVDB's meshToVolume.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include "engine/vdb/vdb_grid.hpp"

namespace palpate {

std::vector<float> vdbMeshDistances(const std::vector<Vec3>& points, const std::vector<Vec3i>& triangles,
                                    const Vec3i& size, float band, float depth) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> vdb_points;
  vdb_points.reserve(points.size());
  for (const Vec3& p : points) {
    vdb_points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  }
  std::vector<openvdb::Vec3I> vdb_triangles;
  vdb_triangles.reserve(triangles.size());
  for (const Vec3i& t : triangles) {
    vdb_triangles.emplace_back(static_cast<openvdb::Index32>(t.x()), static_cast<openvdb::Index32>(t.y()),
                               static_cast<openvdb::Index32>(t.z()));
  }
  const auto grid = openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1.0), vdb_points, vdb_triangles, {}, band, depth);
  const auto values = grid->getConstAccessor();
  std::vector<float> distances;
  distances.reserve(static_cast<std::size_t>(size.cast<long long>().prod()));
  for (int k = 0; k < size.z(); ++k) {
    for (int j = 0; j < size.y(); ++j) {
      for (int i = 0; i < size.x(); ++i) distances.push_back(values.getValue({i, j, k}));
    }
  }
  return distances;
}

}  // namespace palpate
