// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/test_meshes.hpp: triangle meshes that are formulas.
#pragma once

#include <map>
#include <utility>

#include "base/triangle_mesh.hpp"

namespace palpate {

// A box, two triangles a face.
inline TriangleMesh boxMesh(const Vec3& centre_W, const Vec3& size_m) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
    mesh.vertices_W.emplace_back(centre_W + 0.5 * sign.cwiseProduct(size_m));
  }
  const std::uint32_t quads[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

// A prism: a polygon in the xz-plane (counter-clockwise seen from -y, where x goes right and z up), extruded along y
// from -half to +half. `caps`: the triangles of the polygon.
inline TriangleMesh prismMesh(const std::vector<Eigen::Vector2d>& xz_m, double half_m,
                              const std::vector<std::array<std::uint32_t, 3>>& caps) {
  TriangleMesh mesh;
  const auto n = static_cast<std::uint32_t>(xz_m.size());
  for (const double y : {-half_m, half_m}) {
    for (const auto& p : xz_m) mesh.vertices_W.emplace_back(p.x(), y, p.y());
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, n + j, j});
    mesh.triangles.push_back({i, n + i, n + j});
  }
  for (const auto& t : caps) {
    mesh.triangles.push_back({t[0], t[1], t[2]});
    mesh.triangles.push_back({n + t[0], n + t[2], n + t[1]});
  }
  return mesh;
}

// A sphere: an icosahedron whose triangles are cut into four, `levels` times. All vertices lie on the sphere.
inline TriangleMesh sphereMesh(const Vec3& centre_W, double radius_m, int levels) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  TriangleMesh mesh;
  for (const auto& [a, b] : {std::pair(-1.0, g), {1.0, g}, {-1.0, -g}, {1.0, -g}})
    mesh.vertices_W.emplace_back(a, b, 0);
  for (const auto& [a, b] : {std::pair(-1.0, g), {1.0, g}, {-1.0, -g}, {1.0, -g}})
    mesh.vertices_W.emplace_back(0, a, b);
  for (const auto& [a, b] : {std::pair(-1.0, g), {1.0, g}, {-1.0, -g}, {1.0, -g}})
    mesh.vertices_W.emplace_back(b, 0, a);
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& v : mesh.vertices_W) v.normalize();
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [at, fresh] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices_W.size()));
      if (fresh) mesh.vertices_W.push_back((mesh.vertices_W[a] + mesh.vertices_W[b]).normalized());
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  for (Vec3& v : mesh.vertices_W) v = centre_W + radius_m * v;
  return mesh;
}

inline double longestEdge(const TriangleMesh& mesh) {
  double longest_m = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      longest_m = std::max(longest_m, (mesh.vertices_W[t[i]] - mesh.vertices_W[t[(i + 1) % 3]]).norm());
    }
  }
  return longest_m;
}

}  // namespace palpate
