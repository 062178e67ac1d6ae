// SPDX-License-Identifier: Apache-2.0
#include "engine/field/join_triangles.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace palpate {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
constexpr int kMostPasses = 8;
constexpr double kThinnest = 0.02;  // twice a triangle's area over its longest edge, squared
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

class Joiner {
 public:
  Joiner(TriangleMesh& mesh, double adaptivity, double longest)
      : mesh_(mesh), cosine_(std::max(1 - adaptivity, 0.0)), longest_square_(longest * longest) {
    normals_.assign(mesh.vertices_W.size(), Vec3::Zero());
    of_vertex_.resize(mesh.vertices_W.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const std::uint32_t v : mesh.triangles[t]) {
        normals_[v] += normalOf(mesh.triangles[t]);  // weighted by the area
        of_vertex_[v].push_back(static_cast<std::uint32_t>(t));
      }
    }
    for (Vec3& normal : normals_) normal.normalize();
  }

  // Whether any vertex was left out.
  bool pass() {
    bool any = false;
    for (std::uint32_t v = 0; v < of_vertex_.size(); ++v) {
      if (of_vertex_[v].empty()) continue;
      const std::vector<std::uint32_t> around = neighboursOf(v);
      const auto onto =
          std::find_if(around.begin(), around.end(), [&](std::uint32_t u) { return mayJoin(v, u, around); });
      if (onto == around.end()) continue;
      join(v, *onto);
      any = true;
    }
    return any;
  }

  // Takes out what is not used any more.
  void finish() {
    std::vector<std::uint32_t> now(of_vertex_.size(), kNone);
    std::vector<Vec3> vertices_W;
    for (std::size_t v = 0; v < of_vertex_.size(); ++v) {
      if (of_vertex_[v].empty()) continue;
      now[v] = static_cast<std::uint32_t>(vertices_W.size());
      vertices_W.push_back(mesh_.vertices_W[v]);
    }
    std::erase_if(mesh_.triangles, [](const Triangle& t) { return t[0] == kNone; });
    for (Triangle& t : mesh_.triangles) {
      for (std::uint32_t& v : t) v = now[v];
    }
    mesh_.vertices_W = std::move(vertices_W);
  }

 private:
  [[nodiscard]] Vec3 normalOf(const Triangle& t) const {
    const Vec3& a_W = mesh_.vertices_W[t[0]];
    return (mesh_.vertices_W[t[1]] - a_W).cross(mesh_.vertices_W[t[2]] - a_W);
  }
  [[nodiscard]] double squareBetween(std::uint32_t a, std::uint32_t b) const {
    return (mesh_.vertices_W[a] - mesh_.vertices_W[b]).squaredNorm();
  }
  static bool has(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

  // The nearest first.
  [[nodiscard]] std::vector<std::uint32_t> neighboursOf(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t t : of_vertex_[v]) {
      for (const std::uint32_t u : mesh_.triangles[t]) {
        if (u != v && std::find(found.begin(), found.end(), u) == found.end()) found.push_back(u);
      }
    }
    std::sort(found.begin(), found.end(),
              [&](std::uint32_t a, std::uint32_t b) { return squareBetween(a, v) < squareBetween(b, v); });
    return found;
  }

  [[nodiscard]] bool mayJoin(std::uint32_t v, std::uint32_t u, const std::vector<std::uint32_t>& around) const {
    for (const std::uint32_t t : of_vertex_[v]) {
      const Triangle& triangle = mesh_.triangles[t];
      if (!has(triangle, u) && !mayBecome(triangle, v, u)) return false;
    }
    int common = 0;
    for (const std::uint32_t w : neighboursOf(u)) {
      common += std::find(around.begin(), around.end(), w) != around.end() ? 1 : 0;
    }
    // If the vertex has three neighbours, the one new triangle may exist already, on the other side: a tetrahedron.
    return common == 2 && around.size() > 3;
  }

  [[nodiscard]] bool mayBecome(Triangle triangle, std::uint32_t v, std::uint32_t u) const {
    std::replace(triangle.begin(), triangle.end(), v, u);
    const auto [a, b, c] = triangle;
    const double longest_square = std::max({squareBetween(a, b), squareBetween(b, c), squareBetween(c, a)});
    if (longest_square > longest_square_) return false;
    const Vec3 normal = normalOf(triangle);
    const double twice_area = normal.norm();
    if (!(twice_area > kThinnest * longest_square)) return false;
    const auto faces = [&](std::uint32_t w) { return normal.dot(normals_[w]) > cosine_ * twice_area; };
    return faces(a) && faces(b) && faces(c) && faces(v);
  }

  void join(std::uint32_t v, std::uint32_t u) {
    for (const std::uint32_t t : of_vertex_[v]) {
      Triangle& triangle = mesh_.triangles[t];
      if (has(triangle, u)) {
        for (const std::uint32_t w : triangle) {
          if (w != v) std::erase(of_vertex_[w], t);
        }
        triangle.fill(kNone);
      } else {
        std::replace(triangle.begin(), triangle.end(), v, u);
        of_vertex_[u].push_back(t);
      }
    }
    of_vertex_[v].clear();
  }

  TriangleMesh& mesh_;
  double cosine_, longest_square_;
  std::vector<Vec3> normals_;  // of the surface as it was
  std::vector<std::vector<std::uint32_t>> of_vertex_;
};

}  // namespace

void joinFlatTriangles(TriangleMesh& mesh, double adaptivity, double longest) {
  Joiner joiner(mesh, adaptivity, longest);
  for (int pass = 0; pass < kMostPasses && joiner.pass(); ++pass) {
  }
  joiner.finish();
}

}  // namespace palpate
