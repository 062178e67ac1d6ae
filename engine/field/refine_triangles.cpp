// SPDX-License-Identifier: Apache-2.0
#include "engine/field/refine_triangles.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "engine/field/trilinear_cell.hpp"

namespace palpate {
namespace {

constexpr double kLeastGain = 0.0025;  // [voxel^3]
constexpr double kShortest = 0.15;     // [voxel]
constexpr int kMostSplits = 5;
constexpr double kSharpest = 0;         // cosine between the normals of neighbours; sharper ones may turn over
constexpr double kOnSurface = 1e-10;    // [voxel]
constexpr double kThinnestPart = 0.02;  // twice a triangle's area over its longest edge, squared

// The trilinear field in the cells that the surface crosses.
class CrossedField {
 public:
  CrossedField(const SurfaceCells& cells, const Vec3i& size, float isovalue)
      : cells_(cells), size_(size), last_I_(size.cast<double>().array() - 1), isovalue_(isovalue) {}

  [[nodiscard]] const Vec3& last() const { return last_I_; }

  // Density above the isovalue. Empty: in a cell that is not crossed.
  [[nodiscard]] std::optional<double> at(const Vec3& p_I) {
    if (!enter(p_I)) return std::nullopt;
    return cell_.at(p_I - at_.cast<double>());
  }

  // Where a line from `p_I`, against `outward` if the point is outside, meets the surface within `reach`. The line ends
  // at the domain's border.
  [[nodiscard]] std::optional<Vec3> surfaceFrom(const Vec3& p_I, const Vec3& outward, double reach) {
    constexpr int kParts = 4;
    const std::optional<double> here = at(p_I);
    if (!here) return std::nullopt;
    if (*here == 0) return p_I;
    const Vec3 way = (*here > 0 ? reach : -reach) * outward;
    Vec3 before_I = p_I;
    double before = *here;
    for (int part = 1; part <= kParts; ++part) {
      const Vec3 next_I = (p_I + part * way / kParts).cwiseMax(0.0).cwiseMin(last_I_);
      const std::optional<double> next = at(next_I);
      if (!next) continue;
      if ((*next > 0) != (*here > 0)) {
        const Vec3 found_I = zeroBetween(before_I, before, next_I, *next,
                                         [&, sign = before](const Vec3& q_I) { return at(q_I).value_or(sign); });
        // In a cell that is not crossed, the sign was a guess. A wrong one ends at the cell's face, off the surface.
        if (!at(found_I) || roughDistance(found_I) > kOnSurface) return std::nullopt;
        return found_I;
      }
      before_I = next_I;
      before = *next;
    }
    return std::nullopt;
  }

  // How far the surface is from a point, by the field's slope there [voxel]; 0 where that is not known.
  [[nodiscard]] double roughDistance(const Vec3& p_I) {
    if (!enter(p_I)) return 0;
    const Vec3 p = p_I - at_.cast<double>();
    return std::abs(cell_.at(p)) / std::max(cell_.gradient(p).norm(), 1e-300);
  }

 private:
  bool enter(const Vec3& p_I) {
    const Vec3i at = p_I.array().floor().cast<int>().matrix().cwiseMax(0).cwiseMin(size_ - Vec3i::Constant(2));
    if (at != at_) {
      at_ = at;
      const SurfaceCell* found = cells_.find(at);
      crossed_ = found != nullptr;
      for (std::size_t corner = 0; crossed_ && corner < 8; ++corner)
        cell_.excess[corner] = static_cast<double>(found->densities[corner]) - isovalue_;
    }
    return crossed_;
  }

  const SurfaceCells& cells_;
  const Vec3i& size_;
  Vec3 last_I_;
  float isovalue_;
  Vec3i at_ = Vec3i::Constant(-2);  // the cell that was entered last
  bool crossed_ = false;
  TrilinearCell cell_;
};

// Half-edge 3 t + k goes from corner k of triangle t to the next one.
class Refiner {
 public:
  Refiner(TriangleMesh& mesh_I, CrossedField field)
      : vertices_I_(mesh_I.vertices_W), triangles_(mesh_I.triangles), field_(std::move(field)) {
    findTwins();
    depths_.assign(vertices_I_.size(), 0);
  }

  void refine() {
    for (std::uint32_t half = 0; half < twins_.size(); ++half) {
      if (half < twins_[half]) todo_.push_back(edgeOf(half));
    }
    for (std::size_t n = 0; n < todo_.size(); ++n) {  // grows meanwhile
      const Edge edge = todo_[n];
      if (from(edge.half) == edge.from && from(next(edge.half)) == edge.to) trySplit(edge.half);
    }
  }

 private:
  struct Edge {
    std::uint32_t half, from, to;  // its ends when it was put down: a split may have changed what the half-edge is
  };
  static std::uint32_t next(std::uint32_t half) { return half / 3 * 3 + (half + 1) % 3; }
  static std::uint32_t previous(std::uint32_t half) { return half / 3 * 3 + (half + 2) % 3; }
  [[nodiscard]] std::uint32_t from(std::uint32_t half) const { return triangles_[half / 3][half % 3]; }
  [[nodiscard]] Edge edgeOf(std::uint32_t half) const { return {half, from(half), from(next(half))}; }

  void findTwins() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;  // its two vertices, and a half-edge
    edges.reserve(3 * triangles_.size());
    for (std::uint32_t half = 0; half < 3 * triangles_.size(); ++half) {
      const auto [low, high] = std::minmax({from(half), from(next(half))});
      edges.emplace_back(std::uint64_t{low} << 32 | high, half);
    }
    std::sort(edges.begin(), edges.end());
    twins_.resize(edges.size());
    for (std::size_t n = 0; n + 1 < edges.size(); n += 2) join(edges[n].second, edges[n + 1].second);
  }

  [[nodiscard]] Vec3 normalOf(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Vec3& corner_I = vertices_I_[a];
    return (vertices_I_[b] - corner_I).cross(vertices_I_[c] - corner_I);
  }

  // The outward direction along which an edge's middle may move; zero: none. On the border it stays on the border.
  [[nodiscard]] Vec3 outwardOf(const Vec3& a_I, const Vec3& b_I, const Vec3& first, const Vec3& second) const {
    constexpr double kLeast = 1e-3;
    Vec3 outward = first.normalized() + second.normalized();
    for (int axis = 0; axis < 3; ++axis) {
      const auto both = [&](double border) { return a_I[axis] == border && b_I[axis] == border; };
      if (both(0) || both(field_.last()[axis])) outward[axis] = 0;
    }
    return outward.norm() > kLeast ? Vec3(outward.normalized()) : Vec3::Zero();
  }

  // Whether a part of a triangle may take its place, beside a neighbour that stays. `was`: the triangle's normal;
  // `beside`: the half-edge of that neighbour.
  [[nodiscard]] bool mayBe(std::uint32_t a, std::uint32_t b, std::uint32_t c, const Vec3& was,
                           std::uint32_t beside) const {
    const auto square = [&](std::uint32_t u, std::uint32_t v) {
      return (vertices_I_[u] - vertices_I_[v]).squaredNorm();
    };
    const Vec3 normal = normalOf(a, b, c);
    const auto& [u, v, w] = triangles_[beside / 3];
    const Vec3 neighbour = normalOf(u, v, w);
    const double cosine = normal.normalized().dot(neighbour.normalized());
    if (cosine < std::min(kSharpest, was.normalized().dot(neighbour.normalized()))) return false;
    return normal.dot(was) > 0 && normal.norm() > kThinnestPart * std::max({square(a, b), square(b, c), square(c, a)});
  }

  void trySplit(std::uint32_t half) {
    const std::uint32_t twin = twins_[half];
    const std::uint32_t a = from(half), b = from(twin), c = from(previous(half)), d = from(previous(twin));
    const int depth = 1 + std::max(depths_[a], depths_[b]);
    const Vec3 a_I = vertices_I_[a], b_I = vertices_I_[b];
    const double length = (b_I - a_I).norm();
    if (length < kShortest || depth > kMostSplits) return;
    const Vec3 first = normalOf(a, b, c), second = normalOf(b, a, d);
    const double gain_per_height = (first.norm() + second.norm()) / 6;
    const Vec3 middle_I = (a_I + b_I) / 2;
    // The slope changes little over the way to the surface where that way is short: half of what is needed is far from
    // it.
    if (gain_per_height * field_.roughDistance(middle_I) < kLeastGain / 2) return;
    const Vec3 outward = outwardOf(a_I, b_I, first, second);
    if (outward.isZero()) return;
    const std::optional<Vec3> found_I = field_.surfaceFrom(middle_I, outward, length / 2);
    if (!found_I || (*found_I - middle_I).norm() * gain_per_height < kLeastGain) return;
    const auto m = static_cast<std::uint32_t>(vertices_I_.size());
    vertices_I_.push_back(*found_I);
    if (mayBe(a, m, c, first, twins_[previous(half)]) && mayBe(m, b, c, first, twins_[next(half)]) &&
        mayBe(b, m, d, second, twins_[previous(twin)]) && mayBe(m, a, d, second, twins_[next(twin)])) {
      depths_.push_back(static_cast<std::uint8_t>(depth));
      split(half, m);
    } else {
      vertices_I_.pop_back();
    }
  }

  // Triangle a b c becomes a m c and m b c; triangle b a d becomes b m d and m a d.
  void split(std::uint32_t half, std::uint32_t m) {
    const std::uint32_t twin = twins_[half];
    const std::uint32_t a = from(half), b = from(twin), c = from(previous(half)), d = from(previous(twin));
    const std::uint32_t bc = twins_[next(half)], ca = twins_[previous(half)];
    const std::uint32_t ad = twins_[next(twin)], db = twins_[previous(twin)];
    const auto amc = half / 3 * 3, bmd = twin / 3 * 3;
    const auto mbc = static_cast<std::uint32_t>(3 * triangles_.size()), mad = mbc + 3;
    triangles_[half / 3] = {a, m, c};
    triangles_[twin / 3] = {b, m, d};
    triangles_.push_back({m, b, c});
    triangles_.push_back({m, a, d});
    twins_.resize(3 * triangles_.size());
    join(amc, mad);
    join(amc + 1, mbc + 2);
    join(amc + 2, ca);
    join(mbc, bmd);
    join(mbc + 1, bc);
    join(bmd + 1, mad + 2);
    join(bmd + 2, db);
    join(mad + 1, ad);
    for (const std::uint32_t changed : {amc, mbc, amc + 1, bmd + 1, amc + 2, mbc + 1, bmd + 2, mad + 1})
      todo_.push_back(edgeOf(changed));
  }

  void join(std::uint32_t half, std::uint32_t other) {
    twins_[half] = other;
    twins_[other] = half;
  }

  std::vector<Vec3>& vertices_I_;
  std::vector<std::array<std::uint32_t, 3>>& triangles_;
  CrossedField field_;
  std::vector<std::uint32_t> twins_;  // of each half-edge, the one that goes the other way
  std::vector<std::uint8_t> depths_;  // of each vertex, how many splits were made for it, one in the other
  std::vector<Edge> todo_;
};

}  // namespace

void refineTriangles(TriangleMesh& mesh_I, const SurfaceCells& cells, const Vec3i& size, float isovalue) {
  Refiner(mesh_I, CrossedField(cells, size, isovalue)).refine();
}

}  // namespace palpate
