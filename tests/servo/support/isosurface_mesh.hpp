// SPDX-License-Identifier: Apache-2.0
// tests/servo/support/isosurface_mesh.hpp: the isosurface of an analytic volume's samples as a closed triangle mesh.
//
// Marching tetrahedra, six a cell: no table, and no ambiguity. Around the volume lies a layer of background, so a
// surface that reaches the border is closed half a voxel beyond it.
#pragma once

#include <map>
#include <utility>

#include "base/triangle_mesh.hpp"
#include "support/analytic_volume.hpp"

namespace palpate {

class IsosurfaceMesher {
 public:
  IsosurfaceMesher(const AnalyticVolume& volume, double isovalue)
      : volume_(volume), isovalue_(isovalue), count_(volume.size + Vec3i::Constant(2)) {
    values_.reserve(static_cast<std::size_t>(count_.prod()));
    for (int k = 0; k < count_.z(); ++k) {
      for (int j = 0; j < count_.y(); ++j) {
        for (int i = 0; i < count_.x(); ++i) values_.push_back(excess(Vec3i(i, j, k)));
      }
    }
  }

  TriangleMesh mesh() {
    for (int k = 0; k + 1 < count_.z(); ++k) {
      for (int j = 0; j + 1 < count_.y(); ++j) {
        for (int i = 0; i + 1 < count_.x(); ++i) addCell(Vec3i(i, j, k));
      }
    }
    return std::move(mesh_);
  }

 private:
  [[nodiscard]] double excess(const Vec3i& padded) const {
    const Vec3i at = padded - Vec3i::Ones();
    const bool outside = (at.array() < 0).any() || (at.array() >= volume_.size.array()).any();
    const double background = -volume_.lattice.smallestSpacing();
    return outside ? background : volume_.sample(at) - isovalue_;
  }
  [[nodiscard]] std::size_t linear(const Vec3i& at) const {
    return at.x() + count_.x() * (at.y() + count_.y() * static_cast<std::size_t>(at.z()));
  }

  void addCell(const Vec3i& low) {
    constexpr int kTetrahedra[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                       {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    int inside = 0;
    for (int corner = 0; corner < 8; ++corner) inside += values_[linear(cornerOf(low, corner))] > 0 ? 1 : 0;
    if (inside == 0 || inside == 8) return;
    for (const auto& tetrahedron : kTetrahedra) {
      std::vector<Vec3i> in;
      std::vector<Vec3i> out;
      for (const int corner : tetrahedron) {
        const Vec3i at = cornerOf(low, corner);
        (values_[linear(at)] > 0 ? in : out).push_back(at);
      }
      if (in.empty() || out.empty()) continue;
      const Vec3 outward = worldOf(out.front()) - worldOf(in.front());
      if (in.size() == 1) addTriangle(between(in[0], out[0]), between(in[0], out[1]), between(in[0], out[2]), outward);
      if (out.size() == 1) addTriangle(between(in[0], out[0]), between(in[1], out[0]), between(in[2], out[0]), outward);
      if (in.size() == 2 && out.size() == 2) {
        const std::uint32_t quad[] = {between(in[0], out[0]), between(in[0], out[1]), between(in[1], out[1]),
                                      between(in[1], out[0])};
        addTriangle(quad[0], quad[1], quad[2], outward);
        addTriangle(quad[0], quad[2], quad[3], outward);
      }
    }
  }

  static Vec3i cornerOf(const Vec3i& low, int corner) {
    return low + Vec3i(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
  }
  [[nodiscard]] Vec3 worldOf(const Vec3i& padded) const {
    return volume_.lattice.toWorld((padded - Vec3i::Ones()).cast<double>());
  }

  std::uint32_t between(const Vec3i& in, const Vec3i& out) {
    const auto key = std::pair(linear(in), linear(out));
    const auto [found, is_new] = vertices_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices_W.size()));
    if (is_new) {
      const double a = values_[key.first];
      const double b = values_[key.second];
      mesh_.vertices_W.emplace_back(worldOf(in) + (worldOf(out) - worldOf(in)) * (a / (a - b)));
    }
    return found->second;
  }

  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, const Vec3& outward) {
    const auto& v = mesh_.vertices_W;
    const bool faces_out = (v[b] - v[a]).cross(v[c] - v[a]).dot(outward) >= 0;
    mesh_.triangles.push_back(faces_out ? std::array{a, b, c} : std::array{a, c, b});
  }

  const AnalyticVolume& volume_;
  double isovalue_;
  Vec3i count_;
  std::vector<double> values_;  // above the isovalue: inside
  TriangleMesh mesh_;
  std::map<std::pair<std::size_t, std::size_t>, std::uint32_t> vertices_;
};

}  // namespace palpate
