// SPDX-License-Identifier: Apache-2.0
#include "engine/field/face_curve.hpp"

#include <algorithm>
#include <cmath>

#include "engine/field/cell_loops.hpp"

namespace palpate {

// With u and v along the face's axes, the field is first + by_u u + by_v v + by_both u v. Its hyperbola is
// (u - saddle_u) (v - saddle_v) = constant. The chord between two of its points has the slope of the hyperbola where u
// - saddle_u is the geometric mean of that at the two, and so for v.
std::optional<Vec3> farthestOnFace(const TrilinearCell& field, int face, const Vec3& from, const Vec3& to,
                                   double bend) {
  const auto corners = faceCorners(face);
  const auto excess = [&](std::size_t n) { return field.excess[static_cast<std::size_t>(corners[n])]; };
  const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
  const double first = excess(0), by_u = excess(1) - first, by_v = excess(3) - first;
  const double by_both = excess(2) - excess(1) - by_v;
  const double saddle_u = -by_v / by_both, saddle_v = -by_u / by_both;
  const double square_u = (from[u] - saddle_u) * (to[u] - saddle_u);
  const double square_v = (from[v] - saddle_v) * (to[v] - saddle_v);
  if (!(square_u > 0 && square_v > 0 && std::isfinite(square_u) && std::isfinite(square_v))) return std::nullopt;
  Vec3 found = from;
  found[u] = saddle_u + std::copysign(std::sqrt(square_u), from[u] - saddle_u);
  found[v] = saddle_v + std::copysign(std::sqrt(square_v), from[v] - saddle_v);
  // One of the two is computed anew from the other, by the field itself: along the axis on which it changes faster.
  const double slope_u = by_u + by_both * found[v], slope_v = by_v + by_both * found[u];
  if (std::abs(slope_u) > std::abs(slope_v)) {
    found[u] = -(first + by_v * found[v]) / slope_u;
  } else {
    found[v] = -(first + by_u * found[u]) / slope_v;
  }
  for (const int axis : {u, v}) {
    const double least = std::max(std::min(from[axis], to[axis]), kLeastShare);
    const double most = std::min(std::max(from[axis], to[axis]), 1 - kLeastShare);
    if (!(found[axis] > least && found[axis] < most)) return std::nullopt;
  }
  const Vec3 chord = to - from, way = found - from;
  return std::abs(chord[u] * way[v] - chord[v] * way[u]) > bend ? std::optional(found) : std::nullopt;
}

}  // namespace palpate
