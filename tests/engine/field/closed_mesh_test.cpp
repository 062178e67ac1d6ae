// SPDX-License-Identifier: Apache-2.0
// The isosurface's mesh is a closed surface, whatever the densities: two triangles at each edge, going along it in
// opposite senses; one ring of triangles around each vertex; no triangle without an area. Above all at isovalues that
// occur in the data.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>

#include <gtest/gtest.h>

#include "engine/field/isosurface_mesh.hpp"
#include "engine/field/statistics.hpp"
#include "engine/files/volume_file.hpp"
#include "tests/support/middle_of.hpp"
#include "tests/support/scans.hpp"

namespace palpate {
namespace closed_mesh_test {

struct Flaws {
  std::size_t edges = 0;     // that do not belong to two triangles which go along them in opposite senses
  std::size_t vertices = 0;  // around which there is no ring of triangles, or more than one
  std::size_t areas = 0;     // triangles without one
  [[nodiscard]] bool none() const { return edges == 0 && vertices == 0 && areas == 0; }
};
std::ostream& operator<<(std::ostream& out, const Flaws& flaws) {
  return out << flaws.edges << " edges, " << flaws.vertices << " vertices, " << flaws.areas << " areas";
}

// More than what rounding makes of three points on a line.
bool hasArea(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3 first = mesh.vertices_W[t[1]] - mesh.vertices_W[t[0]];
  const Vec3 second = mesh.vertices_W[t[2]] - mesh.vertices_W[t[0]];
  const double longest_square = std::max({first.squaredNorm(), second.squaredNorm(), (second - first).squaredNorm()});
  return first.cross(second).norm() > 1e-9 * longest_square;
}

// The triangles at one vertex: from which of their other corners to which each goes.
using Fan = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

void checkFan(const Fan& fan, Flaws& flaws) {
  for (const auto& [from, to] : fan) {
    const auto begin_there = std::count_if(fan.begin(), fan.end(), [at = to](const auto& t) { return t.first == at; });
    const auto end_there = std::count_if(fan.begin(), fan.end(), [at = to](const auto& t) { return t.second == at; });
    flaws.edges += begin_there == 1 && end_there == 1 ? 0 : 1;
  }
  std::uint32_t at = fan[0].first;
  std::size_t steps = 0;
  do {
    const auto next = std::find_if(fan.begin(), fan.end(), [&](const auto& t) { return t.first == at; });
    if (next == fan.end()) break;
    at = next->second;
  } while (++steps < fan.size() && at != fan[0].first);
  flaws.vertices += steps == fan.size() && at == fan[0].first ? 0 : 1;
}

Flaws flawsOf(const TriangleMesh& mesh) {
  Flaws flaws;
  std::vector<Fan> fans(mesh.vertices_W.size());
  for (const auto& t : mesh.triangles) {
    flaws.areas += hasArea(mesh, t) ? 0 : 1;
    for (std::size_t i = 0; i < 3; ++i) fans[t[i]].emplace_back(t[(i + 1) % 3], t[(i + 2) % 3]);
  }
  for (const Fan& fan : fans) {
    if (fan.empty()) {
      ++flaws.vertices;
    } else {
      checkFan(fan, flaws);
    }
  }
  return flaws;
}

Volume volumeOf(const Vec3i& size, const std::vector<float>& values, const Vec3& spacing_m = Vec3::Constant(1e-3)) {
  return Volume::fromDense(size, {Vec3::Zero(), Mat3::Identity(), spacing_m}, values, {});
}

void expectClosed(const Volume& volume, double isovalue, const std::string& what, bool adaptive = true) {
  for (const double adaptivity : {0.0, 0.1, 1.0}) {
    if (adaptivity > 0 && !adaptive) break;
    const TriangleMesh mesh = isosurfaceMesh(volume, isovalue, adaptivity);
    const Flaws flaws = flawsOf(mesh);
    ASSERT_TRUE(flaws.none()) << what << " at " << isovalue << ", adaptivity " << adaptivity << ": " << flaws << " of "
                              << mesh.triangles.size() << " triangles";
  }
}

// Two cells with a face in common, in all 4096 ways; each of the 256 cells is among them with every neighbour. At an
// isovalue that every voxel outside has.
TEST(ClosedMesh, OfTwoCellsInEveryWay) {
  for (unsigned set = 0; set < 1U << 12; ++set) {
    Vec3i size = Vec3i::Constant(2);
    size[static_cast<int>(set % 3)] = 3;
    std::vector<float> values;
    for (unsigned n = 0; n < 12; ++n) values.push_back((set >> n & 1) != 0 ? 1.0F : 0.0F);
    const Volume volume = volumeOf(size, values);
    expectClosed(volume, 0, "two cells " + std::to_string(set), set % 64 == 0);
    if (HasFatalFailure()) return;
    EXPECT_EQ(isosurfaceMesh(volume, 0).triangles.empty(), set == 0);
  }
}

// Few different integers: saddles at the isovalue, plateaus at it, corners that only touch.
TEST(ClosedMesh, OfRandomIntegers) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> side(2, 16);
  std::uniform_real_distribution<double> length(0.3e-3, 3e-3);
  for (int round = 0; round < 40; ++round) {
    const Vec3i size(side(random), side(random), side(random));
    std::uniform_int_distribution<int> value(0, round % 5 == 0 ? 1 : round % 5 == 1 ? 200 : 3);
    std::vector<float> values(static_cast<std::size_t>(size.prod()));
    for (float& v : values) v = static_cast<float>(value(random));
    const Volume volume = volumeOf(size, values, {length(random), length(random), length(random)});
    for (const double isovalue : {0.0, 1.0, 2.0, 100.0, 0.5}) {
      expectClosed(volume, isovalue, "round " + std::to_string(round), round % 4 == 0);
      if (HasFatalFailure()) return;
    }
  }
}

// Bricks without storage on either side, and a border in the middle of a brick.
TEST(ClosedMesh, AcrossBricksOfOneValue) {
  for (const Vec3i& size : {Vec3i(24, 16, 17), Vec3i(9, 40, 8)}) {
    std::vector<float> values;
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      values.push_back(((voxel / 8).sum() % 2) != 0 ? 7.0F : 3.0F);
    }
    expectClosed(volumeOf(size, values), 3, "bricks");
  }
}

// A voxel that only just stands out is not lost. All others are at the isovalue: in its eight cells the trilinear field
// is above it everywhere but on their far faces. The ring of three crossings in each cell has a vertex near the far
// corner.
TEST(ClosedMesh, OfVoxelsJustAboveTheIsovalue) {
  std::vector<float> values(std::size_t{5} * 5 * 5, 1000.0F);
  values[62] = std::nextafter(1000.0F, 2000.0F);
  const Volume volume = volumeOf(Vec3i::Constant(5), values);
  const TriangleMesh mesh = isosurfaceMesh(volume, 1000);
  EXPECT_TRUE(flawsOf(mesh).none()) << flawsOf(mesh);
  EXPECT_EQ(mesh.triangles.size(), 24U);
  int near_corners = 0;  // each 1/256 from the far faces of its cell
  for (const Vec3& vertex_W : mesh.vertices_W) {
    const Vec3 off_I = (volume.lattice().toIndex(vertex_W) - Vec3::Constant(2)).cwiseAbs();
    near_corners += (off_I - Vec3::Constant(255.0 / 256)).norm() < 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(near_corners, 8);
}

// Every scan at whole numbers: what Otsu finds, and a quarter of the largest density. (Whole scans take the mesher some
// seconds each, so of large ones the middle.)
TEST(ClosedMesh, OfScansAtWholeNumbers) {
  const auto scans = realScans();
  if (scans.empty()) GTEST_SKIP() << kNoScans;
  for (const auto& scan : scans) {
    const std::string name = scan.filename().string();
    const Volume volume = middleOf(loadVolume(scan.string()), 56);
    expectClosed(volume, std::round(defaultIsovalue(volume)), name);
    expectClosed(volume, std::round(volume.maximum() / 4), name, false);
  }
}

}  // namespace closed_mesh_test
}  // namespace palpate
