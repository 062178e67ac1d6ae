// SPDX-License-Identifier: Apache-2.0
#include "engine/field/surface_vertices.hpp"

#include <algorithm>
#include <limits>

#include "engine/field/trilinear_cell.hpp"

namespace palpate {
namespace {

Vec3 cornerPlace(int corner) {
  return {static_cast<double>(corner & 1), static_cast<double>(corner >> 1 & 1), static_cast<double>(corner >> 2)};
}

class Vertices {
 public:
  Vertices(const SurfaceCell& cell, const Vec3i& size, float isovalue) : cell_(cell), size_(size) {
    // Beyond the domain the field goes on as at the border, so on the border it is the border's own.
    for (int corner = 0; corner < 8; ++corner) {
      const auto from = static_cast<std::size_t>(withinDomain(corner));
      field_.excess[static_cast<std::size_t>(corner)] = static_cast<double>(cell.densities[from]) - isovalue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      low_[axis] = cell.at[axis] + 1 == size[axis] ? 0 : cell.at[axis] < 0 ? 1 : kLeastShare;
      high_[axis] = cell.at[axis] < 0 ? 1 : cell.at[axis] + 1 == size[axis] ? 0 : 1 - kLeastShare;
    }
  }

  // In the cell's own frame.
  [[nodiscard]] Vec3 of(int loop) const {
    Vec3 crossings = Vec3::Zero(), ends = Vec3::Zero(), outward = Vec3::Zero();
    int crossing_count = 0, end_count = 0;
    for (int edge = 0; edge < kCellEdges; ++edge) {
      if (cell_.loops.of_edge[static_cast<std::size_t>(edge)] != loop) continue;
      const EdgeEnds corners = edgeEnds(edge);
      if (holds(corners.first) && holds(corners.last)) {
        crossings += crossingOf(corners);
        outward += (isInside(corners.first) ? 1 : -1) * (cornerPlace(corners.last) - cornerPlace(corners.first));
        ++crossing_count;
      } else {
        ends += cornerPlace(holds(corners.first) ? corners.first : corners.last);
        ++end_count;
      }
    }
    if (crossing_count == 0) return within(ends / end_count);
    const Vec3 middle = crossings / crossing_count;
    const bool two_rims = end_count > 0 && crossing_count == 4;
    return within(two_rims ? middle : onSurface(loop, middle, outward));
  }

 private:
  [[nodiscard]] bool isInside(int corner) const { return (cell_.inside >> corner & 1) != 0; }
  [[nodiscard]] Vec3i voxelOf(int corner) const { return cell_.at + cornerPlace(corner).cast<int>(); }
  [[nodiscard]] bool holds(int corner) const {
    const Vec3i voxel = voxelOf(corner);
    return (voxel.array() >= 0).all() && (voxel.array() < size_.array()).all();
  }
  // The cell's corner at the voxel of the domain that is nearest to this corner's.
  [[nodiscard]] int withinDomain(int corner) const {
    const Vec3i voxel = voxelOf(corner).cwiseMax(0).cwiseMin(size_ - Vec3i::Ones()) - cell_.at;
    return voxel.x() | voxel.y() << 1 | voxel.z() << 2;
  }
  [[nodiscard]] Vec3 within(const Vec3& p) const { return p.cwiseMax(low_).cwiseMin(high_); }

  [[nodiscard]] Vec3 crossingOf(const EdgeEnds& ends) const {
    const double first = field_.excess[static_cast<std::size_t>(ends.first)];
    const double last = field_.excess[static_cast<std::size_t>(ends.last)];
    const double share = std::clamp(first / (first - last), kLeastShare, 1 - kLeastShare);
    return cornerPlace(ends.first) + share * (cornerPlace(ends.last) - cornerPlace(ends.first));
  }

  [[nodiscard]] Vec3 onSurface(int loop, const Vec3& middle, const Vec3& outward) const {
    if (const auto found = field_.surfaceFrom(middle, outward)) return *found;
    const bool is_inside = field_.at(middle) > 0;
    Vec3 nearest = middle;
    double least = std::numeric_limits<double>::infinity();
    for (int edge = 0; edge < kCellEdges; ++edge) {
      const EdgeEnds ends = edgeEnds(edge);
      if (cell_.loops.of_edge[static_cast<std::size_t>(edge)] != loop || !holds(ends.first) || !holds(ends.last))
        continue;
      const Vec3 way = cornerPlace(isInside(ends.first) == is_inside ? ends.last : ends.first) - middle;
      const auto found = field_.surfaceFrom(middle, is_inside ? way : Vec3(-way));
      if (!found || !((*found - middle).squaredNorm() < least)) continue;
      nearest = *found;
      least = (*found - middle).squaredNorm();
    }
    return nearest;
  }

  const SurfaceCell& cell_;
  const Vec3i& size_;
  TrilinearCell field_;
  Vec3 low_, high_;  // of what vertices may be
};

}  // namespace

std::array<Vec3, 4> surfaceVertices(const SurfaceCell& cell, const Vec3i& size, float isovalue) {
  const Vertices vertices(cell, size, isovalue);
  std::array<Vec3, 4> places_I;
  for (int loop = 0; loop < cell.loops.count; ++loop)
    places_I[static_cast<std::size_t>(loop)] = cell.at.cast<double>() + vertices.of(loop);
  return places_I;
}

}  // namespace palpate
