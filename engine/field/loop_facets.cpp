// SPDX-License-Identifier: Apache-2.0
#include "engine/field/loop_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/field/cell_loops.hpp"
#include "engine/field/shared_vertices.hpp"

namespace palpate {
namespace {

class LoopFacets {
 public:
  LoopFacets(const FacetCell& cell, const std::vector<RingVertex>& ring, const FacetGains& gains, TriangleMesh& mesh_I)
      : cell_(cell), field_(cell.field), ring_(ring), gains_(gains), mesh_(mesh_I) {
    for (const RingVertex& v : ring) mean_ += placeOf(v.vertex) / static_cast<double>(ring.size());
    for (std::size_t n = 0; n < ring.size(); ++n) area_ += (at(n) - mean_).cross(at(n + 1) - mean_) / 2;
  }

  void add() {
    if (!addFromOneVertex()) addAroundCentre();
  }

 private:
  [[nodiscard]] Vec3 placeOf(std::uint32_t vertex) const { return mesh_.vertices_W[vertex] - cell_.origin_I; }
  [[nodiscard]] std::uint32_t vertexAt(std::size_t n) const { return ring_[n % ring_.size()].vertex; }
  [[nodiscard]] Vec3 at(std::size_t n) const { return placeOf(vertexAt(n)); }
  std::uint32_t addVertex(const Vec3& place) {
    mesh_.vertices_W.push_back(cell_.origin_I + place);
    return static_cast<std::uint32_t>(mesh_.vertices_W.size() - 1);
  }
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { mesh_.triangles.push_back({a, b, c}); }

  // Whether a triangle faces down the field's slope at its middle, as the world has it: there both its normal and the
  // slope are those of index space over the spacing, axis by axis.
  [[nodiscard]] bool facesOut(const Vec3& a, const Vec3& b, const Vec3& c) const {
    return (b - a).cross(c - a).cwiseProduct(cell_.per_spacing2).dot(field_.gradient((a + b + c) / 3)) < 0;
  }
  // The same, of a part of the triangle with the normal `was`, which it must not turn over.
  [[nodiscard]] bool mayReplace(const Vec3& was, const Vec3& a, const Vec3& b, const Vec3& c) const {
    return (b - a).cross(c - a).dot(was) > 0 && facesOut(a, b, c);
  }
  // How far the surface is, by the field's slope.
  [[nodiscard]] double roughDistance(const Vec3& p) const {
    return std::abs(field_.at(p)) / std::max(field_.gradient(p).norm(), std::numeric_limits<double>::min());
  }

  // Whether triangles that all have vertex n of the ring share no edge with those of a neighbouring cell.
  [[nodiscard]] bool mayBeginAt(std::size_t n) const {
    for (std::size_t k = 2; k + 1 < ring_.size(); ++k) {
      if (shareFace(ring_[n].edge, ring_[(n + k) % ring_.size()].edge)) return false;
    }
    return true;
  }

  // What is between such triangles and the surface, roughly [voxel^3].
  [[nodiscard]] double missedFrom(std::size_t n) const {
    double missed = 0;
    for (std::size_t k = 1; k + 1 < ring_.size(); ++k) {
      const Vec3 a = at(n), b = at(n + k), c = at(n + k + 1);
      missed += (b - a).cross(c - a).norm() / 2 * roughDistance((a + b + c) / 3);
      if (!facesOut(a, b, c)) missed += std::numeric_limits<float>::max();
    }
    return missed;
  }

  bool addFromOneVertex() {
    if (std::any_of(ring_.begin(), ring_.end(), [](const RingVertex& v) { return v.edge == kOnLine; })) return false;
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n < ring_.size(); ++n) {
      if (!mayBeginAt(n)) continue;
      const double missed = missedFrom(n);
      if (!(missed < least)) continue;
      least = missed;
      best = n;
    }
    if (!(least < gains_.centre)) return false;
    for (std::size_t k = 1; k + 1 < ring_.size(); ++k)
      addTriangle(vertexAt(best), vertexAt(best + k), vertexAt(best + k + 1));
    return true;
  }

  [[nodiscard]] Vec3 centre() const {
    if (const auto found = field_.surfaceFrom(mean_, area_.normalized())) return *found;
    const bool is_inside = field_.at(mean_) > 0;
    Vec3 nearest = mean_;
    double least = std::numeric_limits<double>::infinity();
    for (const RingVertex& v : ring_) {
      if (v.edge == kOnLine) continue;
      const EdgeEnds ends = edgeEnds(v.edge);
      const bool first_is_inside = (cell_.inside >> ends.first & 1) != 0;
      const int corner = first_is_inside == is_inside ? ends.last : ends.first;
      const Vec3 way = cornerPlace(corner).cast<double>() - mean_;
      const auto found = field_.surfaceFrom(mean_, is_inside ? way : Vec3(-way));
      if (!found || !((*found - mean_).squaredNorm() < least)) continue;
      nearest = *found;
      least = (*found - mean_).squaredNorm();
    }
    return nearest;
  }

  // The vertex on the edge from the centre to vertex n of the ring. Empty: it needs none.
  [[nodiscard]] std::optional<Vec3> middleTo(const Vec3& centre, std::size_t n) const {
    constexpr double kLeastNormal = 0.2;  // of two unit normals' sum: the edge is too sharp for a mean normal
    const Vec3 before = at(n + ring_.size() - 1), end = at(n), after = at(n + 1);
    const Vec3 first = (before - centre).cross(end - centre), second = (end - centre).cross(after - centre);
    const double gain_per_height = (first.norm() + second.norm()) / 6;
    const Vec3 middle = (centre + end) / 2;
    // The slope changes little over the way to the surface where that way is short: half the gain is far from it.
    if (gain_per_height * roughDistance(middle) < gains_.middle / 2) return std::nullopt;
    const Vec3 outward = first.normalized() + second.normalized();
    if (outward.norm() < kLeastNormal) return std::nullopt;
    const auto found = field_.surfaceFrom(middle, outward.normalized());
    if (!found) return std::nullopt;
    const Vec3& m = *found;
    const double height = (m - middle).norm();
    if (height > (end - centre).norm() / 2 || height * gain_per_height < gains_.middle) return std::nullopt;
    if ((m.array() < kLeastShare).any() || (m.array() > 1 - kLeastShare).any()) return std::nullopt;
    const bool may_be = mayReplace(first, centre, before, m) && mayReplace(first, before, end, m) &&
                        mayReplace(second, centre, m, after) && mayReplace(second, m, end, after);
    return may_be ? found : std::nullopt;
  }

  // Between the vertices on the edges to vertices n and n + 1 of the ring and these, the diagonal that begins at the
  // former. Empty: neither it nor the other one leaves all triangles facing out.
  [[nodiscard]] std::optional<bool> diagonalFromFirst(const Vec3& centre, std::size_t n, const Vec3& from_middle,
                                                      const Vec3& to_middle) const {
    const Vec3 from = at(n), to = at(n + 1), was = (from - centre).cross(to - centre);
    if (!mayReplace(was, centre, from_middle, to_middle)) return std::nullopt;
    const bool first = mayReplace(was, from_middle, from, to) && mayReplace(was, from_middle, to, to_middle);
    const bool second = mayReplace(was, from_middle, from, to_middle) && mayReplace(was, from, to, to_middle);
    if (!first && !second) return std::nullopt;
    if (first != second) return first;
    return (from_middle - to).squaredNorm() < (to_middle - from).squaredNorm();
  }

  void addAroundCentre() {
    const Vec3 place = centre().cwiseMax(kLeastShare).cwiseMin(1 - kLeastShare);
    const std::size_t sides = ring_.size();
    std::vector<std::optional<Vec3>> middles(sides);
    for (std::size_t n = 0; n < sides; ++n) middles[n] = middleTo(place, n);
    std::vector<bool> from_first(sides);
    for (std::size_t n = 0; n < sides; ++n) {
      std::optional<Vec3>& next = middles[(n + 1) % sides];
      if (!middles[n] || !next) continue;
      const std::optional<bool> diagonal = diagonalFromFirst(place, n, *middles[n], *next);
      from_first[n] = diagonal.value_or(false);
      if (!diagonal) next.reset();  // alone, the other one has been looked at
    }
    const std::uint32_t centre_vertex = addVertex(place);
    std::vector<std::uint32_t> middle_vertices(sides, kNoVertex);
    for (std::size_t n = 0; n < sides; ++n)
      if (middles[n]) middle_vertices[n] = addVertex(*middles[n]);
    for (std::size_t n = 0; n < sides; ++n)
      addSector(centre_vertex, n, middle_vertices[n], middle_vertices[(n + 1) % sides], from_first[n]);
  }

  // The triangle from the centre to a side of the ring, with vertices on its edges at the centre or without.
  void addSector(std::uint32_t centre, std::size_t side, std::uint32_t from_middle, std::uint32_t to_middle,
                 bool diagonal_from_first) {
    const std::uint32_t from = vertexAt(side), to = vertexAt(side + 1);
    const bool has_from = from_middle != kNoVertex, has_to = to_middle != kNoVertex;
    addTriangle(centre, has_from ? from_middle : from, has_to ? to_middle : to);
    if (has_from && has_to) {
      addTriangle(from_middle, from, diagonal_from_first ? to : to_middle);
      addTriangle(diagonal_from_first ? from_middle : from, to, to_middle);
    } else if (has_from) {
      addTriangle(from_middle, from, to);
    } else if (has_to) {
      addTriangle(from, to, to_middle);
    }
  }

  const FacetCell& cell_;
  const TrilinearCell& field_;
  const std::vector<RingVertex>& ring_;
  const FacetGains& gains_;
  TriangleMesh& mesh_;
  Vec3 mean_ = Vec3::Zero();
  Vec3 area_ = Vec3::Zero();
};

}  // namespace

void addLoopFacets(const FacetCell& cell, const std::vector<RingVertex>& ring, const FacetGains& gains,
                   TriangleMesh& mesh_I) {
  LoopFacets(cell, ring, gains, mesh_I).add();
}

}  // namespace palpate
