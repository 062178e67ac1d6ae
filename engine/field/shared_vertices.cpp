// SPDX-License-Identifier: Apache-2.0
#include "engine/field/shared_vertices.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/field/face_curve.hpp"

namespace palpate {
namespace {

// The cell that owns the vertex at a voxel on the border. The surface crosses it: it reaches beyond the domain.
Vec3i ownerOf(const Vec3i& voxel) {
  return voxel - (voxel.array() == 0).cast<int>().matrix();
}

}  // namespace

SharedVertices::SharedVertices(const SurfaceCells& cells, const Vec3i& size, float isovalue, double bend,
                               std::vector<Vec3>& places_I)
    : cells_(cells), size_(size), isovalue_(isovalue), places_I_(places_I) {
  owned_.reserve(cells.all().size());
  for (const SurfaceCell& cell : cells.all()) {
    Owned owned{{kNoVertex, kNoVertex, kNoVertex}, {}, kNoVertex};
    for (int axis = 0; axis < 3; ++axis) {
      const bool crossed = ((cell.inside ^ cell.inside >> (1 << axis)) & 1) != 0;
      if (crossed && holds(cell.at) && holds(cell.at + Vec3i::Unit(axis)))
        owned.edges[static_cast<std::size_t>(axis)] = add(cell.at.cast<double>() + crossing(cell, edgeFrom(0, axis)));
      owned.lines[static_cast<std::size_t>(axis)] = {kNoVertex, kNoVertex};
      if (holdsFace(cell, 2 * axis)) addLines(cell, axis, bend, owned);
    }
    const Vec3i voxel = cell.at.cwiseMax(0);
    const bool on_border = (voxel.array() == 0).any() || (voxel.array() == size.array() - 1).any();
    const Vec3i corner = voxel - cell.at;
    const bool is_inside = (cell.inside >> (corner.x() | corner.y() << 1 | corner.z() << 2) & 1) != 0;
    if (on_border && is_inside && ownerOf(voxel) == cell.at) owned.voxel = add(voxel.cast<double>());
    owned_.push_back(owned);
  }
}

bool SharedVertices::holds(const Vec3i& voxel) const {
  return (voxel.array() >= 0).all() && (voxel.array() < size_.array()).all();
}

bool SharedVertices::holdsFace(const SurfaceCell& cell, int face) const {
  const auto corners = faceCorners(face);
  return holds(cell.at + cornerPlace(corners[0])) && holds(cell.at + cornerPlace(corners[2]));
}

std::uint32_t SharedVertices::onEdge(const SurfaceCell& cell, int edge) const {
  return ownedBy(cell.at + cornerPlace(edgeEnds(edge).first)).edges[static_cast<std::size_t>(edge / 4)];
}

std::uint32_t SharedVertices::onLine(const SurfaceCell& cell, int face, int line) const {
  const Vec3i owner = cell.at + face % 2 * Vec3i::Unit(face / 2);
  return ownedBy(owner).lines[static_cast<std::size_t>(face / 2)][static_cast<std::size_t>(line)];
}

std::uint32_t SharedVertices::atCorner(const SurfaceCell& cell, int corner) const {
  return ownedBy(ownerOf(cell.at + cornerPlace(corner))).voxel;
}

Vec3 SharedVertices::crossing(const SurfaceCell& cell, int edge) const {
  const EdgeEnds ends = edgeEnds(edge);
  const auto excess = [&](int corner) {
    return static_cast<double>(cell.densities[static_cast<std::size_t>(corner)]) - isovalue_;
  };
  const double first = excess(ends.first), last = excess(ends.last);
  const double share = std::clamp(first / (first - last), kLeastShare, 1 - kLeastShare);
  return cornerPlace(ends.first).cast<double>() + share * Vec3::Unit(edge / 4);
}

void SharedVertices::addLines(const SurfaceCell& cell, int axis, double bend, Owned& owned) {
  const int face = 2 * axis;
  const FaceLines found = faceLines(cell.inside, cell.joined, face);
  const TrilinearCell field = trilinearCell(cell, isovalue_);
  for (std::size_t n = 0; n < static_cast<std::size_t>(found.count); ++n) {
    const FaceLine& line = found.lines[n];
    const auto place = farthestOnFace(field, face, crossing(cell, line.from), crossing(cell, line.to), bend);
    if (place) owned.lines[static_cast<std::size_t>(axis)][n] = add(cell.at.cast<double>() + *place);
  }
}

std::uint32_t SharedVertices::add(const Vec3& place_I) {
  places_I_.push_back(place_I);
  return static_cast<std::uint32_t>(places_I_.size() - 1);
}

}  // namespace palpate
