// SPDX-License-Identifier: Apache-2.0
// The mesh of a real scan as its file has it, in floats: a closed surface, and each triangle with an area. At densities
// that voxels of the scan have, where crossings lie next to voxels and triangles are smallest.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <unordered_map>

#include <gtest/gtest.h>

#include "apps/mesh/mesh_file.hpp"
#include "apps/mesh/mesh_writer.hpp"
#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/apps/report/temporary_folder.hpp"
#include "tests/support/middle_of.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace scan_mesh_test {

struct Flaws {
  std::size_t edges = 0;  // that do not belong to two triangles which go along them in opposite senses
  std::size_t areas = 0;  // triangles without one
};

// The differences of floats are exact in double. A cross product of two of them is off by a few roundings of products,
// 2^-53 of the longest edge's square each, so what is above ten of them is no rounding: the triangle has an area.
bool hasArea(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest_square = std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
  return (b - a).cross(c - a).norm() > std::ldexp(10.0, -53) * longest_square;
}

// Equal places are one vertex, as in an STL.
Flaws flawsOf(const TriangleMesh& mesh) {
  Flaws flaws;
  std::map<std::array<double, 3>, std::uint64_t> places;
  std::unordered_map<std::uint64_t, int> ways;  // from place to place, as the triangles go
  for (const auto& triangle : mesh.triangles) {
    const Vec3 &a = mesh.vertices_W[triangle[0]], &b = mesh.vertices_W[triangle[1]], &c = mesh.vertices_W[triangle[2]];
    flaws.areas += hasArea(a, b, c) ? 0 : 1;
    std::array<std::uint64_t, 3> corners{};
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3& v = mesh.vertices_W[triangle[n]];
      corners[n] = places.emplace(std::array{v.x(), v.y(), v.z()}, places.size()).first->second;
    }
    for (std::size_t n = 0; n < 3; ++n) ++ways[corners[n] << 32U | corners[(n + 1) % 3]];
  }
  for (const auto& [way, count] : ways) {
    const auto back = ways.find(way << 32U | way >> 32U);
    flaws.edges += count == 1 && back != ways.end() && back->second == 1 ? 0 : 1;
  }
  return flaws;
}

// That nearest to what Otsu finds; not the largest, which encloses nothing.
double isovalueInTheData(const Volume& volume) {
  const double wanted = defaultIsovalue(volume);
  double nearest = volume.minimum();
  for (const float value : volume.toDense()) {
    if (value < volume.maximum() && std::abs(value - wanted) < std::abs(nearest - wanted)) nearest = value;
  }
  return nearest;
}

TEST(ScanMesh, IsClosedInItsFile) {
  const auto scans = realScans();
  if (scans.empty()) GTEST_SKIP() << kNoScans;
  const TemporaryFolder folder;
  for (const auto& scan : scans) {
    const Volume volume = middleOf(loadVolume(scan.string()), 56);
    const double isovalue = isovalueInTheData(volume);
    EXPECT_EQ(isovalue, std::round(isovalue)) << scan;
    const TriangleMesh mesh = isosurfaceMesh(volume, isovalue);
    for (const char* name : {"a.stl", "a.ply"}) {
      const std::string path = (folder.path() / name).string();
      {
        std::ofstream file(path, std::ios::binary);
        writeMesh(mesh, path, 1000, [&](std::string_view bytes) { file << bytes; });
      }
      const TriangleMesh back = readMeshFile(path);
      const Flaws flaws = flawsOf(back);
      EXPECT_EQ(back.triangles.size(), mesh.triangles.size()) << scan << ' ' << name;
      EXPECT_EQ(flaws.edges, 0U) << scan << ' ' << name << " at " << isovalue;
      EXPECT_EQ(flaws.areas, 0U) << scan << ' ' << name << " at " << isovalue;
    }
  }
}

}  // namespace scan_mesh_test
}  // namespace palpate
