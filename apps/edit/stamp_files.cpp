// SPDX-License-Identifier: Apache-2.0
#include "apps/edit/stamp_files.hpp"

#include <algorithm>

#include "apps/mesh/mesh_file.hpp"
#include "base/error.hpp"
#include "base/triangle_mesh.hpp"

namespace palpate {
namespace {

constexpr std::size_t kKeptBytes = std::size_t{512} << 20U;

std::size_t bytesOf(const Stamp& stamp) {
  return stamp.distance_m.size() * sizeof(float);
}

double widthOf(const std::vector<Vec3>& points) {
  Vec3 low = points.front();
  Vec3 high = low;
  for (const Vec3& point : points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  return (high - low).maxCoeff();
}

}  // namespace

std::shared_ptr<const Stamp> StampFiles::read(const std::string& file, double metres_per_unit, double depth_m) const {
  TriangleMesh mesh = readMeshFile(file);
  for (Vec3& vertex : mesh.vertices_W) vertex *= metres_per_unit;
  const PreparedMesh prepared = prepareMesh(std::move(mesh), file);
  if (!prepared.closed) {
    throw Error(Error::Code::kBadInput, file, "the mesh is not closed, so it has no inside",
                "close its holes, and give neighbours the same corners");
  }
  std::vector<Vec3i> triangles;
  triangles.reserve(prepared.mesh.triangles.size());
  for (const auto& t : prepared.mesh.triangles)
    triangles.emplace_back(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
  const std::vector<Vec3>& points = prepared.mesh.vertices_W;
  // The lattice reaches the band beyond the mesh, and less than 8 voxels more (mesh_distance.cpp rounds up four times).
  const double coarsest_m = (widthOf(points) + 2 * profile_.band_m) / (kMaxMeshVoxels - 8);
  const double voxel_m = std::max(lattice_.smallestSpacing(), coarsest_m);
  return std::make_shared<const Stamp>(meshDistance(points, triangles, voxel_m, profile_.band_m, depth_m));
}

void StampFiles::forget() {
  std::size_t bytes = 0;
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    bytes += bytesOf(*kept->stamp);
    kept = bytes > kKeptBytes && kept != kept_.begin() ? kept_.erase(kept) : std::next(kept);
  }
}

// An object density that is not above the isovalue is refused when the edit is applied.
std::shared_ptr<const Stamp> StampFiles::stampOf(const EditText& edit) {
  const double object = std::max(edit.command.object.value_or(profile_.object), profile_.object);
  return stampOf(edit.mesh_file, edit.metres_per_unit, object);
}

std::shared_ptr<const Stamp> StampFiles::stampOf(const std::string& file, double metres_per_unit, double object) {
  const double depth_m = rampDepth(profile_, object);
  const auto known = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) {
    return kept.file == file && kept.metres_per_unit == metres_per_unit && kept.depth_m >= depth_m;
  });
  if (known != kept_.end()) {
    kept_.splice(kept_.begin(), kept_, known);
  } else {
    kept_.push_front({file, metres_per_unit, depth_m, read(file, metres_per_unit, depth_m)});
    forget();
  }
  return kept_.front().stamp;
}

}  // namespace palpate
