// SPDX-License-Identifier: Apache-2.0
#include "base/triangle_mesh.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

void checkMesh(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.triangles.empty()) refuse(name, "the mesh has no triangles", "give a surface made of triangles");
  for (const Triangle& triangle : mesh.triangles) {
    const std::uint32_t last = *std::max_element(triangle.begin(), triangle.end());
    if (last >= mesh.vertices_W.size()) {
      refuse(name, fmt::format("a triangle names vertex {} of {}", last, mesh.vertices_W.size()), "mend the mesh");
    }
  }
  const auto bad = std::find_if(mesh.vertices_W.begin(), mesh.vertices_W.end(),
                                [](const Vec3& vertex_W) { return !vertex_W.allFinite(); });
  if (bad != mesh.vertices_W.end()) {
    refuse(name, fmt::format("vertex {} is not finite", bad - mesh.vertices_W.begin()), "mend the mesh");
  }
  Vec3 low_W = mesh.vertices_W.front();
  Vec3 high_W = low_W;
  for (const Vec3& vertex_W : mesh.vertices_W) {
    low_W = low_W.cwiseMin(vertex_W);
    high_W = high_W.cwiseMax(vertex_W);
  }
  const double side_m = (high_W - low_W).maxCoeff();
  if (side_m <= kLargestMesh_m) return;
  refuse(name,
         fmt::format("the mesh is {:g} mm wide, and {:g} mm is the most", side_m * kMillimetresPerMetre,
                     kLargestMesh_m * kMillimetresPerMetre),
         "check its unit and scale");
}

// Vertices at one place get one index; vertices that no triangle uses are dropped.
void weld(TriangleMesh& mesh) {
  const std::vector<Vec3>& old = mesh.vertices_W;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return std::lexicographical_compare(old[a].begin(), old[a].end(), old[b].begin(), old[b].end());
  };
  std::vector<std::uint32_t> order(old.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), before);
  std::vector<std::uint32_t> renamed(old.size());
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || before(order[i - 1], order[i])) kept.push_back(old[order[i]]);
    renamed[order[i]] = static_cast<std::uint32_t>(kept.size() - 1);
  }
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = renamed[corner];
  }
  mesh.vertices_W = std::move(kept);
}

// Lists each edge once for each triangle: its lower index, its higher index, and whether it goes upwards.
bool everyEdgeIsBalanced(const TriangleMesh& mesh) {
  struct Edge {
    std::uint32_t low, high;
    int upwards;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangle[i];
      const std::uint32_t to = triangle[(i + 1) % 3];
      if (from == to) continue;  // the triangle is a line
      edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  const auto same = [](const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; };
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return a.low != b.low ? a.low < b.low : a.high < b.high; });
  for (auto edge = edges.begin(); edge != edges.end();) {
    int sum = 0;
    const Edge first = *edge;
    for (; edge != edges.end() && same(first, *edge); ++edge) sum += edge->upwards;
    if (sum != 0) return false;
  }
  return true;
}

Vec3 crossOf(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vec3& a = mesh.vertices_W[triangle[0]];
  return (mesh.vertices_W[triangle[1]] - a).cross(mesh.vertices_W[triangle[2]] - a);
}

double longestEdge(const TriangleMesh& mesh, const Triangle& triangle) {
  double longest_m = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    longest_m = std::max(longest_m, (mesh.vertices_W[triangle[i]] - mesh.vertices_W[triangle[(i + 1) % 3]]).norm());
  }
  return longest_m;
}

// |cross| is the longest edge times the height over it.
bool hasPlane(const TriangleMesh& mesh, const Triangle& triangle) {
  const double longest_m = longestEdge(mesh, triangle);
  return crossOf(mesh, triangle).norm() > kThinnest_m * longest_m;
}

}  // namespace

double sixfoldVolume(const TriangleMesh& mesh) noexcept {
  if (mesh.vertices_W.empty()) return 0;
  const Vec3 origin_W = mesh.vertices_W.front();
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    sum += (mesh.vertices_W[t[0]] - origin_W)
               .dot((mesh.vertices_W[t[1]] - origin_W).cross(mesh.vertices_W[t[2]] - origin_W));
  }
  return sum;
}

PreparedMesh prepareMesh(TriangleMesh mesh, const std::string& name) {
  checkMesh(mesh, name);
  weld(mesh);
  PreparedMesh prepared;
  prepared.closed = everyEdgeIsBalanced(mesh);
  const std::size_t all = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&](const Triangle& triangle) { return !hasPlane(mesh, triangle); });
  if (mesh.triangles.empty()) refuse(name, "all its triangles are degenerate", "give a surface with an area");
  if (const std::size_t dropped = all - mesh.triangles.size(); dropped > 0) {
    prepared.notes.push_back(
        fmt::format("{}: {} of {} triangles are degenerate and were left out", name, dropped, all));
  }
  const double volume = sixfoldVolume(mesh);
  if (!prepared.closed || volume == 0) {
    prepared.closed = false;
    prepared.notes.push_back(name + ": the mesh is not closed, so it is touched from both sides");
  } else if (volume < 0) {
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    prepared.notes.push_back(name + ": its normals point inwards and were turned");
  }
  for (const Triangle& triangle : mesh.triangles) prepared.normals_W.push_back(crossOf(mesh, triangle).normalized());
  prepared.mesh = std::move(mesh);
  return prepared;
}

}  // namespace palpate
